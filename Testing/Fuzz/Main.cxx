// SPDX-License-Identifier: BSD-3-Clause
// Tests vtkDeformVolumeFilter in random pipelines. After each edit, either the output equals that
// of a new filter to the last bit, and that of the host reference if this can be computed, or both
// filters report the same error. The seed alone determines a pipeline.
#include "Pipeline.h"
#include "Subject.h"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iostream>
#include <sstream>
#include <string>

#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define FUZZ_SANITIZE
#include <sanitizer/common_interface_defs.h>
#endif

namespace
{

struct Arguments
{
  std::uint64_t Seed = 1;
  std::uint64_t Count = ~std::uint64_t(0);
  double Seconds = 0.0;
  unsigned int Timeout = 120;
  bool Verbose = false;
  bool KeepGoing = false;
};

// The seed of the pipeline as text. A signal handler cannot convert the number.
char SeedText[64] = "";

void WriteSeed()
{
  // A signal handler cannot report that writing failed.
  if (write(STDERR_FILENO, SeedText, std::strlen(SeedText)) < 0)
  {
    return;
  }
}

extern "C" void HandleSignal(int signal)
{
  WriteSeed();
  const char* text = signal == SIGALRM ? "it hangs\n" : "it crashed\n";
  if (write(STDERR_FILENO, text, std::strlen(text)) >= 0)
  {
    std::signal(SIGABRT, SIG_DFL);
    std::abort();
  }
}

void CatchSignals()
{
  std::signal(SIGALRM, HandleSignal);
#ifdef FUZZ_SANITIZE
  __sanitizer_set_death_callback(WriteSeed);
#else
  for (const int signal : { SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT })
  {
    std::signal(signal, HandleSignal);
  }
#endif
}

int PrintUsage(std::ostream& stream, int code)
{
  stream << "Usage: DeformVolumeFuzz [--seed FIRST] [--count PIPELINES] [--seconds LIMIT]\n"
            "                        [--timeout SECONDS] [--keep-going] [--verbose]\n"
            "Runs random pipelines with the seeds FIRST, FIRST + 1 and so on. Without --count and\n"
            "--seconds it runs 1000. A pipeline that takes longer than --timeout (120) ends the\n"
            "program. To repeat one pipeline: --seed SEED --count 1.\n";
  return code;
}

bool Parse(int argc, char* argv[], Arguments& arguments)
{
  for (int i = 1; i < argc; ++i)
  {
    const std::string name = argv[i];
    if (name == "--verbose")
    {
      arguments.Verbose = true;
      continue;
    }
    if (name == "--keep-going")
    {
      arguments.KeepGoing = true;
      continue;
    }
    if (i + 1 == argc)
    {
      return false;
    }
    const char* value = argv[++i];
    char* end = nullptr;
    if (name == "--seed")
    {
      arguments.Seed = std::strtoull(value, &end, 10);
    }
    else if (name == "--count")
    {
      arguments.Count = std::strtoull(value, &end, 10);
    }
    else if (name == "--seconds")
    {
      arguments.Seconds = std::strtod(value, &end);
    }
    else if (name == "--timeout")
    {
      arguments.Timeout = static_cast<unsigned int>(std::strtoul(value, &end, 10));
    }
    if (!end || *end != '\0' || end == value)
    {
      return false;
    }
  }
  if (arguments.Seconds <= 0.0 && arguments.Count == ~std::uint64_t(0))
  {
    arguments.Count = 1000;
  }
  return true;
}

struct Totals
{
  std::uint64_t Pipelines = 0;
  std::uint64_t Outputs = 0;
  std::uint64_t Errors = 0;
  std::uint64_t References = 0;
  fuzz::Pipeline::LiveUpdates Live;
  std::uint64_t Failures = 0;
};

void RunOne(
  std::uint64_t seed, const Arguments& arguments, fuzz::StrayMessages* stray, Totals& totals)
{
  std::snprintf(SeedText, sizeof(SeedText),
    "\nIn the pipeline of seed %llu: ", static_cast<unsigned long long>(seed));
  alarm(arguments.Timeout);
  std::ostringstream text;
  std::ostream& log = arguments.Verbose ? std::cout : text;
  std::string wrong;
  try
  {
    fuzz::Pipeline pipeline(seed, log);
    wrong = pipeline.Run();
    totals.Outputs += static_cast<std::uint64_t>(pipeline.GetNumberOfOutputs());
    totals.Errors += static_cast<std::uint64_t>(pipeline.GetNumberOfErrors());
    totals.References += static_cast<std::uint64_t>(pipeline.GetNumberOfReferences());
    const fuzz::Pipeline::LiveUpdates& live = pipeline.GetLiveUpdates();
    totals.Live.All += live.All;
    totals.Live.Parts += live.Parts;
    totals.Live.FoldedParts += live.FoldedParts;
    totals.Live.SplitParts += live.SplitParts;
  }
  catch (const std::exception& error)
  {
    wrong = std::string("an exception: ") + error.what();
  }
  alarm(0);
  ++totals.Pipelines;
  const std::string said = stray->Take();
  if (wrong.empty() && !said.empty())
  {
    wrong = "an object other than the filter reported: " + said;
  }
  if (!wrong.empty())
  {
    ++totals.Failures;
    std::cout << "FAILED: the pipeline of seed " << seed << '\n'
              << text.str() << "  wrong: " << wrong << std::endl;
  }
}

} // namespace

int main(int argc, char* argv[])
{
  Arguments arguments;
  if (!Parse(argc, argv, arguments))
  {
    return PrintUsage(std::cerr, EXIT_FAILURE);
  }
  CatchSignals();
  std::cout << std::unitbuf; // so that all output is written before a crash
  vtkNew<fuzz::StrayMessages> stray;
  vtkOutputWindow::SetInstance(stray);
  std::cout << "First seed: " << arguments.Seed << std::endl;
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const auto getSeconds = [start]
  { return std::chrono::duration<double>(Clock::now() - start).count(); };
  Totals totals;
  while (totals.Pipelines < arguments.Count &&
    (arguments.Seconds <= 0.0 || getSeconds() < arguments.Seconds) &&
    (totals.Failures == 0 || arguments.KeepGoing))
  {
    RunOne(arguments.Seed + totals.Pipelines, arguments, stray, totals);
  }
  vtkOutputWindow::SetInstance(nullptr);
  std::cout << totals.Pipelines << " pipelines in " << getSeconds() << " s: " << totals.Outputs
            << " outputs, " << totals.References << " of them compared with the reference, "
            << totals.Errors << " expected errors, " << totals.Failures << " pipelines failed\n";
  const fuzz::Pipeline::LiveUpdates& live = totals.Live;
  std::cout << live.All << " updates of large volumes: " << live.Parts << " in part, "
            << live.FoldedParts << " of these folded, " << live.SplitParts << " of split meshes\n";
  if (live.All > 200 &&
    (5 * live.Parts < live.All || 40 * live.FoldedParts < live.All ||
      40 * live.SplitParts < live.All))
  {
    std::cout << "Too few updates in part: expected at least a fifth of all updates in part, a "
                 "fortieth folded, and a fortieth of split meshes.\n";
    return EXIT_FAILURE;
  }
  if (totals.Outputs == 0 && arguments.Count > 1)
  {
    std::cout << "No pipeline had an output: all had errors.\n";
    return EXIT_FAILURE;
  }
  return totals.Failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
