#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Tests the linker of the Python package: its errors, and a library that it makes.
#
# Usage: CheckLinker.sh <linker> <C compiler> <folder to work in>
set -euo pipefail
linker=$(realpath "$1") compiler=$2 folder=$3
source=$(realpath "$(dirname "$0")")/linked.c
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"

failed=0
refuse() # words of the message, arguments
{
  if "$linker" "${@:2}" >message 2>&1; then
    echo "expected an error with \"$1\", but there was none: ${*:2}"
    failed=1
  elif ! grep -q "$1" message; then
    echo "expected an error with \"$1\" instead of \"$(cat message)\": ${*:2}"
    failed=1
  fi
}

"$compiler" -O2 -fno-builtin -fPIC -c "$source" -o linked.o
refuse "only shared libraries" -o x.so linked.o
refuse "cannot read none.o" -shared -o x.so none.o
refuse "option -o needs a value" -shared linked.o -o
refuse "cannot write" -shared -o /nowhere/x.so linked.o
refuse "defined twice" -shared -o x.so linked.o linked.o
refuse "not an object file" -shared -o x.so "$source"
refuse "truncated" -shared -o x.so /dev/null
head -c 1000 linked.o >cut.o
refuse "truncated" -shared -o x.so cut.o
"$compiler" -O2 -fno-PIC -mcmodel=large -c "$source" -o large.o
refuse "not compiled with -fPIC" -shared -o x.so large.o
echo '__thread int x; int f(void) { return x; }' >thread.c
"$compiler" -fPIC -c thread.c -o thread.o
refuse "thread-local" -shared -o x.so thread.o

for option in -O0 -O2; do
  for extra in -fno-builtin "-fno-builtin -fvisibility=hidden -fno-plt"; do
    # shellcheck disable=SC2086 # a list of options
    "$compiler" $option $extra -fPIC -c "$source" -o linked.o
    "$linker" --hash-style=both -m elf_x86_64 -shared -o linked.so -L/usr/lib linked.o -lm -lgcc \
      --as-needed -lgcc_s --no-as-needed -lc
    case $extra in *hidden*)
      # With hidden visibility no symbol may be exported.
      readelf --dyn-syms --wide linked.so | grep -q ' linked_' && {
        echo "$option $extra: the library exports symbols with hidden visibility"
        failed=1
      }
      continue ;;
    esac
    cat >main.c <<'MAIN'
#include <dlfcn.h>
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
int main(void)
{
  void* const library = dlopen("./linked.so", RTLD_NOW);
  double (*multiply)(int, double);
  int64_t (*sum)(void);
  int* (*errors)(void);
  if (!library)
  {
    puts(dlerror());
    return 1;
  }
  *(void**)&multiply = dlsym(library, "linked_multiply");
  *(void**)&sum = dlsym(library, "linked_sum");
  *(void**)&errors = dlsym(library, "linked_errors");
  if (!multiply || !sum || !errors || dlsym(library, "compare"))
  {
    puts("wrong names");
    return 1;
  }
  if (multiply(0, 3.0) != 1.5 || multiply(3, 3.0) != 12.0 || sum() != 10144 || errors() != &errno)
  {
    printf("%g %g %ld\n", multiply(0, 3.0), multiply(3, 3.0), (long)sum());
    return 1;
  }
  return 0;
}
MAIN
    "$compiler" main.c -o main -ldl
    ./main || failed=1
  done
done
exit $failed
