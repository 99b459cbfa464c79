#pragma once
// What Python's headers ask about a 64-bit Windows with GCC. CPython's own PC/pyconfig.h serves Microsoft's compiler,
// and comes with the installer for Windows only; the other headers are the same on every system.

#define MS_WINDOWS
#define MS_WIN64
#define Py_ENABLE_SHARED 1
#define HAVE_DECLSPEC_DLL
#define NT_THREADS
#define WITH_DOC_STRINGS 1

#define SIZEOF_INT 4
#define SIZEOF_LONG 4
#define SIZEOF_LONG_LONG 8
#define SIZEOF_WCHAR_T 2
#define SIZEOF_VOID_P 8
#define SIZEOF_SIZE_T 8

#define HAVE_STDDEF_H 1
#define HAVE_SYS_STAT_H 1
#define HAVE_WCHAR_H 1
