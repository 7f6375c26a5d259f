// Only carries the precompiled start of the test programs.
