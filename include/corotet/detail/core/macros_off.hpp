// Puts aside those macros of platforms (windows.h, X11, complex.h, termios.h, Unreal Engine, Arduino) whose names are
// used in Eigen or in the standard library, until macros_on.hpp brings them back. The two stand around headers of
// others, each time anew: they have no guard.

#pragma push_macro("B1")
#pragma push_macro("Complex")
#pragma push_macro("Data")
#pragma push_macro("F")
#pragma push_macro("I")
#pragma push_macro("IN")
#pragma push_macro("K")
#pragma push_macro("Status")
#pragma push_macro("Success")
#pragma push_macro("THIS")
#pragma push_macro("abs")
#pragma push_macro("bit")
#pragma push_macro("check")
#pragma push_macro("max")
#pragma push_macro("min")
#pragma push_macro("round")
#undef B1
#undef Complex
#undef Data
#undef F
#undef I
#undef IN
#undef K
#undef Status
#undef Success
#undef THIS
#undef abs
#undef bit
#undef check
#undef max
#undef min
#undef round
