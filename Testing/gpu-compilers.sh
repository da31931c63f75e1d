#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Compiles the OpenCL programs of this library for GPUs, without a GPU, and prints a table for each
# compiler: registers, spills and occupancy. Fails if a program does not compile.
#
# Usage: gpu-compilers.sh [--only PATTERN] [COMPILER]...
#   nvidia    clang with libclc's builtins to PTX, and CUDA's ptxas from PTX
#   amd       clang with ROCm's device libraries
#   spirv     clang and llvm-spirv to SPIR-V, which spirv-val checks
#   intel     Intel's graphics compiler: ocloc, installed or in build/ocloc. These commands extract
#             it without installing the driver of the same package:
#             mkdir -p build/ocloc && cd build/ocloc && apt-get download intel-opencl-icd libigc1 \
#               libigdfcl1 libigdgmm12 libopencl-clang14 libllvmspirvlib14 &&
#             for package in *.deb; do dpkg -x "$package" .; done
#   oclgrind  not a compiler: counts instructions of the resampling kernels for a small volume
# Default: all of them. Compilers that are not installed are skipped.
# bash Testing/packages.sh gpu-compilers installs all of them except ptxas and ocloc.
#   --only    compiles only programs whose names match a pattern of grep -E, such as
#             'ResampleDeferredInt32-links'
#
# Uses the build of preset vtk, or of the build directory DEFORMVOLUME_BUILD. Writes to
# build/gpu-compilers. CUDA is expected in CUDA_HOME, by default /usr/local/cuda.
# shellcheck disable=SC2317 # functions are called by composed names
set -euo pipefail
cd "$(dirname "$0")/.."

build=$(realpath "${DEFORMVOLUME_BUILD:-build/vtk}")
output=$PWD/build/gpu-compilers
cuda=${CUDA_HOME:-/usr/local/cuda}

nvidia_targets="sm_70 sm_75 sm_80 sm_86 sm_90"
# The oldest target: ptxas assembles its PTX for all targets above.
ptx_target=sm_70
amd_targets="gfx906 gfx90a gfx1030"
# The first two targets have double precision, the last two do not.
intel_targets="skl pvc tgllp dg2-g10"

only=
if [ "${1-}" = --only ]; then
  only=$2
  shift 2
fi
compilers=("$@")
[ ${#compilers[@]} -gt 0 ] || compilers=(nvidia amd spirv intel oclgrind)
for compiler in "${compilers[@]}"; do
  case $compiler in
    nvidia | amd | spirv | intel | oclgrind) ;;
    *)
      echo "gpu-compilers.sh: no compiler $compiler; there are: nvidia amd spirv intel oclgrind" >&2
      exit 2
      ;;
  esac
done
[ -x "$build/bin/KernelTexts" ] || {
  echo "Build first: cmake --preset vtk && cmake --build --preset vtk" >&2
  exit 1
}

is_wanted()
{
  [[ " ${compilers[*]} " == *" $1 "* ]]
}

find_first() # NAME...: prints the path of the first one that is a program
{
  local name
  for name in "$@"; do
    command -v "$name" && return
  done
  return 0
}

title()
{
  printf '\n## %s\n\n' "$*"
}

skip()
{
  title "$1"
  echo "Skipped: there is no $2."
}

programs() # PRECISION...: prints the files of the programs
{
  local precision
  for precision in "$@"; do
    find "$output/texts/$precision" -name '*.cl'
  done | grep -E -- "${only:-.}" | sort || true
}

# Calls a function for each file of the standard input, in parallel. The function gets the file, the
# path of its output without a suffix, and the further arguments.
for_each() # FUNCTION FOLDER [ARGUMENT]...
{
  mkdir -p "$2"
  xargs -r -P "$(nproc)" -I{} bash -c 'make_one "$@"' make_one {} "$@"
}

# Calls a function for a file. If the function fails, its output is kept in NAME.errors.
make_one() # FILE FUNCTION FOLDER [ARGUMENT]...
{
  local file=$1 function=$2 base precision
  precision=$(basename "$(dirname "$file")")
  base=$3/$precision.$(basename "$file" .cl)
  shift 3
  rm -f "$base".*
  if "$function" "$file" "$base" "$@" >"$base.printed" 2>&1; then
    rm "$base.printed"
  else
    mv "$base.printed" "$base.errors"
  fi
}

# Calls clang with the options of a program, and with further options, such as the target.
front() # FILE [OPTION]...
{
  local file=$1
  shift
  # Drivers define __OPENCL_VERSION__. All targets have atomic operations of 64 bits.
  # shellcheck disable=SC2046 # a list of words
  "$clang" -x cl $(cat "${file%.cl}.options") -D__OPENCL_VERSION__=120 -O3 \
    -Xclang -cl-ext=+cl_khr_int64_base_atomics,+cl_khr_int64_extended_atomics "$@" "$file"
}

make_ptx()
{
  front "$1" -target nvptx64-nvidia-nvcl -Xclang -target-cpu -Xclang "$ptx_target" -S -o "$2.ptx" \
    -Xclang -mlink-builtin-bitcode -Xclang "$output/builtins.bc" \
    -Xclang -mlink-builtin-bitcode -Xclang "$libclc"
}

assemble_ptx() # makes the listing from which gpu_tables.py makes the table
{
  local limit
  limit=$(sed -n 's/.*-cl-nv-maxrregcount=\([0-9]*\).*/--maxrregcount=\1/p' "${1%.cl}.nvidia")
  # ptxas has no built-in functions of OpenCL, so it fails if a function is still undefined.
  # shellcheck disable=SC2086 # no word, or one
  "$ptxas" -v $limit -arch="$3" "$ptx/$(basename "$2").ptx" -o "$2.cubin" >"$2.listing" 2>&1 || {
    cat "$2.listing"
    return 1
  }
  mv "$2.listing" "$2.log"
}

make_amd()
{
  front "$1" -target amdgcn-amd-amdhsa -mcpu="$3" --rocm-device-lib-path="$rocm" -S -o "$2.s"
}

make_spirv()
{
  local environment=opencl1.2
  # Programs with atomic operations of 64 bits need an extension.
  if grep -q cl_khr_int64_base_atomics "$1"; then
    environment=spv1.0
  fi
  # llvm-spirv does not support all instructions of optimized code.
  front "$1" -target spir64-unknown-unknown -O0 -emit-llvm -c -o "$2.bc" &&
    "$llvm_spirv" --spirv-max-version=1.0 "$2.bc" -o "$2.spv" &&
    spirv-val --target-env "$environment" "$2.spv"
}

make_intel()
{
  LD_LIBRARY_PATH=$ocloc_libraries "$ocloc" compile -file "$1" -device "$3" -options "$(cat "${1%.cl}.options")" \
    -out_dir "$2.binaries" >"$2.listing" 2>&1 || {
    cat "$2.listing"
    return 1
  }
  rm -r "$2.binaries"
  mv "$2.listing" "$2.log"
}

report_failures() # FOLDER
{
  local errors count=0
  for errors in "$1"/*.errors; do
    [ -e "$errors" ] || continue
    failed=1
    count=$((count + 1))
    if [ "$count" -gt 5 ]; then
      printf '\nMore programs do not compile: %s/*.errors\n' "${1#"$PWD"/}"
      return
    fi
    printf '\n%s does not compile:\n\n' "$(basename "$errors" .errors)"
    # Print the first lines of the error.
    sed -n 's/^/    /; 1,12p' "$errors"
  done
}

run_nvidia()
{
  local target targets=()
  libclc=/usr/lib/clc/nvptx64--nvidiacl.bc
  ptxas=$cuda/bin/ptxas
  if [ -z "$clang" ] || [ ! -e "$libclc" ]; then
    skip NVIDIA "clang-15 with libclc-15"
    return
  fi
  ptx=$output/nvidia/ptx
  export libclc ptxas ptx ptx_target output
  "$clang" -x cl -cl-std=CL1.2 -target nvptx64-nvidia-nvcl -Xclang -target-cpu -Xclang "$ptx_target" \
    -Xclang -cl-ext=+cl_khr_int64_base_atomics -O3 -emit-llvm -c -o "$output/builtins.bc" \
    Testing/gpu-builtins.cl
  programs double | for_each make_ptx "$ptx"
  if [ ! -x "$ptxas" ]; then
    skip NVIDIA "ptxas of CUDA: only PTX was made"
  else
    for target in $nvidia_targets; do
      if "$ptxas" --help | grep "'$target'" >/dev/null; then
        targets+=("$target")
      fi
    done
    for target in "${targets[@]}"; do
      programs double | for_each assemble_ptx "$output/nvidia/$target" "$target"
    done
    title "NVIDIA: $("$clang" --version | head -1), ptxas $("$ptxas" --version |
      sed -n 's/.* V\([0-9.]*\)$/\1/p')"
    /usr/bin/python3 Testing/gpu_tables.py "$output" nvidia "${targets[@]}"
  fi
  report_failures "$ptx"
  for target in "${targets[@]}"; do
    report_failures "$output/nvidia/$target"
  done
}

run_amd()
{
  local target
  rocm=$(find /usr/lib -maxdepth 4 -type d -path '*/amdgcn/bitcode' 2>/dev/null | head -1)
  if [ -z "$clang" ] || [ -z "$rocm" ]; then
    skip AMD "clang-15 with rocm-device-libs"
    return
  fi
  export rocm
  for target in $amd_targets; do
    programs double | for_each make_amd "$output/amd/$target" "$target"
  done
  title "AMD: $("$clang" --version | head -1)"
  # shellcheck disable=SC2086 # a list of words
  /usr/bin/python3 Testing/gpu_tables.py "$output" amd $amd_targets
  for target in $amd_targets; do
    report_failures "$output/amd/$target"
  done
}

run_spirv()
{
  local folder=$output/spirv all
  llvm_spirv=$(find_first llvm-spirv-15)
  if [ -z "$clang" ] || [ -z "$llvm_spirv" ] || [ -z "$(find_first spirv-val)" ]; then
    skip SPIR-V "clang-15 with llvm-spirv-15 and spirv-tools"
    return
  fi
  export llvm_spirv
  programs double single | for_each make_spirv "$folder"
  title "SPIR-V: $("$clang" --version | head -1)"
  all=$(programs double single | wc -l)
  echo "Of $all programs $((all - $(find "$folder" -name '*.errors' | wc -l))) become valid SPIR-V."
  report_failures "$folder"
}

run_intel()
{
  local target
  ocloc=$(find_first "$PWD/build/ocloc/usr/bin/ocloc" ocloc)
  ocloc_libraries=
  if [ -z "$ocloc" ]; then
    skip Intel ocloc
    return
  fi
  if [[ $ocloc == "$PWD"/* ]]; then
    ocloc_libraries=$(dirname "$(find build/ocloc -name libocloc.so)")
  fi
  export ocloc ocloc_libraries
  for target in $intel_targets; do
    programs "$(intel_precision "$target")" | for_each make_intel "$output/intel/$target" "$target"
  done
  title "Intel: ocloc with IGC"
  # shellcheck disable=SC2086 # a list of words
  /usr/bin/python3 Testing/gpu_tables.py "$output" intel $intel_targets
  for target in $intel_targets; do
    report_failures "$output/intel/$target"
  done
}

# Lets Oclgrind count those instructions of LLVM that become instructions of CPUs or GPUs.
run_oclgrind()
{
  local icd=/usr/lib/oclgrind/liboclgrind-rt-icd.so form shape file runs=() folder=$output/oclgrind
  if [ ! -e "$icd" ]; then
    skip Oclgrind Oclgrind
    return
  fi
  mkdir -p "$folder"
  title "Oclgrind: 16 x 16 x 16 voxels of 16 bits, links"
  for form in columns cells; do
    for shape in still moved jittered folded; do
      runs+=("$form-$shape")
      file=$folder/$form-$shape.txt
      # Functions are not inlined, because Oclgrind 21.10 does not support all instructions that its own
      # compiler creates in inlined functions.
      # shellcheck disable=SC2046 # no word, or one
      OCL_ICD_VENDORS=$icd OCLGRIND_INST_COUNTS=1 OCLGRIND_BUILD_OPTIONS=-fno-inline \
        "$build/bin/FirstUpdate" $([ "$shape" = moved ] || echo "$shape") "$form" 16 oclgrind \
        >"$file" 2>&1 && continue
      # Oclgrind does not support all functions that its compiler creates for expressions, either.
      if grep -q '^Undefined external function' "$file"; then
        printf 'Not counted: %s. %s\n\n' "$form-$shape" "$(grep '^Undefined external' "$file")"
      else
        failed=1
        cat "$file"
      fi
    done
  done
  /usr/bin/python3 Testing/gpu_tables.py "$output" oclgrind "${runs[@]}"
}

intel_precision()
{
  case $1 in
    skl | pvc) echo double ;;
    *) echo single ;;
  esac
}

# libclc and llvm-spirv belong to this version of clang, and ROCm's libraries work with it.
clang=$(find_first clang-15)
export clang
export -f make_one front make_ptx assemble_ptx make_amd make_spirv make_intel

export POCL_CACHE_DIR=$output/kernel-cache
rm -rf "$output/texts"
for precision in double single; do
  mkdir -p "$output/texts/$precision"
  "$build/bin/KernelTexts" "$output/texts/$precision" "$precision"
done

failed=0
for compiler in nvidia amd spirv intel oclgrind; do
  if is_wanted $compiler; then
    rm -rf "${output:?}/$compiler"
    "run_$compiler"
  fi
done
exit $failed
