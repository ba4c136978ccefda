// Stops one thread of a program for as long as this one runs: a signal would stop all of them.
// Usage: hold_thread TID

#include <sys/ptrace.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv) {
  const pid_t thread = argc == 2 ? std::atoi(argv[1]) : 0;
  if (thread <= 0) {
    std::fputs("usage: hold_thread TID\n", stderr);
    return 2;
  }
  if (::ptrace(PTRACE_SEIZE, thread, nullptr, nullptr) != 0 ||
      ::ptrace(PTRACE_INTERRUPT, thread, nullptr, nullptr) != 0) {
    std::perror("hold_thread");
    return 1;
  }
  ::pause();
}
