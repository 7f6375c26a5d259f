// Compiles if the library's headers use no name that a header of a platform makes a macro. The macros are those of the
// platforms, in their forms. By default they are there before any header; with COROTET_TEST_HEADERS_FIRST headers of
// the standard library come first, with COROTET_TEST_EIGEN_FIRST Eigen, too, as in programs that include their platform
// late.
#if defined(COROTET_TEST_HEADERS_FIRST)
#include <cmath>
#include <cstdlib>
#endif
#if defined(COROTET_TEST_EIGEN_FIRST)
#include <Eigen/Dense>
#endif

// windows.h (minwindef.h, rpcndr.h, combaseapi.h, wingdi.h, winnt.h, excpt.h)
#define near
#define far
#define NEAR
#define FAR
#define small char
#define hyper __int64
#define huge
#define pascal
#define cdecl
#define interface struct
#define min(a, b) (((a) < (b)) ? (a) : (b))
#define max(a, b) (((a) > (b)) ? (a) : (b))
#define CONST const
#define VOID void
#define TRUE 1
#define FALSE 0
#define IN
#define OUT
#define OPTIONAL
#define ERROR 0
#define NO_ERROR 0L
#define DELETE (0x00010000L)
#define INFINITE 0xFFFFFFFF
#define IGNORE 0
#define RELATIVE 2
#define ABSOLUTE 1
#define TRANSPARENT 1
#define OPAQUE 2
#define STRICT 1
#define THIS void
#define GetObject GetObjectA
#define GetMessage GetMessageA
#define CreateFile CreateFileA
#define CopyFile CopyFileA
#define leave __leave
#define DOMAIN 1
#define OVERFLOW 3
#define UNDERFLOW 4

// X11/X.h, X11/Xlib.h, X11/Xutil.h
#define Status int
#define Bool int
#define True 1
#define False 0
#define None 0L
#define Success 0
#define Always 2
#define Above 0
#define Below 1
#define Complex 0
#define Convex 2
#define Nonconvex 1
#define Unsorted 0
#define YSorted 1
#define CurrentTime 0L
#define CursorShape 0
#define DestroyAll 0
#define RetainPermanent 1
#define KeyPress 2
#define KeyRelease 3
#define ButtonPress 4
#define FocusIn 9
#define FocusOut 10
#define Expose 12
#define GrayScale 1
#define StaticColor 2
#define ControlMask (1 << 2)
#define Opposite 4
#define Bottom 1

// Unreal Engine's Core, and AssertMacros.h of macOS
#define check(expr)                \
  {                                \
    if (!(expr)) __builtin_trap(); \
  }
#define checkf(expr, ...)          \
  {                                \
    if (!(expr)) __builtin_trap(); \
  }
#define verify(expr)               \
  {                                \
    if (!(expr)) __builtin_trap(); \
  }
#define ensure(expr) (expr)
#define require(expr, label) \
  do {                       \
    if (!(expr)) goto label; \
  } while (0)
#define TEXT(x) L##x
#define PI (3.1415926535897932f)
#define HALF_PI (1.57079632679f)
#define SMALL_NUMBER (1.e-8f)
#define BIG_NUMBER (3.4e+38f)
#define INLINE inline
#define RESTRICT __restrict
#define nil nullptr
#define Nil nullptr

// Arduino.h, and termios.h
#define TWO_PI 6.283185307179586476925286766559
#define DEG_TO_RAD 0.017453292519943295769236907684886
#define EULER 2.718281828459045235360287471352
#define HIGH 0x1
#define LOW 0x0
#define INPUT 0x0
#define OUTPUT 0x1
#define CHANGE 1
#define DEFAULT 1
#define INTERNAL 3
#define EXTERNAL 0
#define F(text) (text)
#if defined(COROTET_TEST_HEADERS_FIRST)  // the C library itself does not survive these two
#define abs(x) ((x) > 0 ? (x) : -(x))
#define round(x) ((x) >= 0 ? (long)((x) + 0.5) : (long)((x)-0.5))
#endif
#define radians(deg) ((deg)*DEG_TO_RAD)
#define degrees(rad) ((rad) / DEG_TO_RAD)
#define sq(x) ((x) * (x))
#define constrain(amt, low, high) ((amt) < (low) ? (low) : ((amt) > (high) ? (high) : (amt)))
#define bit(b) (1UL << (b))
#define word(...) (__VA_ARGS__)
#define lowByte(w) ((w)&0xff)
#define B0 0000000
#define B1 1
#define B50 0000001

// Qt
#define signals public
#define slots
#define emit
#define foreach(variable, container) for (variable : container)
#define forever for (;;)

// complex.h, sys/param.h, sys/sysmacros.h, linux/keyboard.h, GLib, Godot, the predefined names of GNU modes
#define I (__extension__ 1.0iF)
#define MIN(a, b) (((a) < (b)) ? (a) : (b))
#define MAX(a, b) (((a) > (b)) ? (a) : (b))
#define ABS(a) (((a) < 0) ? -(a) : (a))
#define CLAMP(x, low, high) (((x) > (high)) ? (high) : (((x) < (low)) ? (low) : (x)))
#define SIGN(x) ((x) < 0 ? -1 : 1)
#define SWAP(x, y) std::swap((x), (y))
#define major(dev) gnu_dev_major(dev)
#define minor(dev) gnu_dev_minor(dev)
#define K(t, v) (((t) << 8) | (v))
#define likely(x) __builtin_expect(!!(x), 1)
#define unlikely(x) __builtin_expect(!!(x), 0)
#define unix 1
#define linux 1

#include <corotet/corotet.hpp>

// The macros are still there, and as they were.
#if !defined(near) || !defined(Status) || !defined(Success) || !defined(check) || !defined(I) || !defined(F)
#error "a header of the library has removed a macro of the program"
#endif
static_assert(Success == 0 && None == 0 && sq(3) == 9 && MAX(1, 2) == 2);
static_assert(sizeof(Status) == sizeof(int) && sizeof(small) == 1);

// Templates are checked in full only when they are used.
int main() {
  using namespace corotet;
  auto block = make_block({.size = {1, 0.2, 0.2}, .cells = {2, 1, 1}, .order = 2});
  auto mesh = TetMesh<float, Tet10>::create(*block);
  auto body = SoftBody<float, Tet10>::create(*mesh, Material{.young = 5e5, .poisson = 0.3, .density = 1000});
  if (!body) return 1;
  body->pin_where([](const Vec3<float>& x) { return x.x() == 0; });
  ImplicitEuler euler(*body);
  Bdf2 second_order(*body);
  const bool stepped = euler.step(*body, 0.01f).ok() && second_order.step(*body, 0.01f).ok();
  auto surface =
      EmbeddedSurface<float, Tet10>::bind(*mesh, compact_surface(*extract_boundary(*block), block->positions).surface);
  const Result<MeshData> read = read_mesh("none");
  return stepped && surface && !read ? 0 : 1;
}
