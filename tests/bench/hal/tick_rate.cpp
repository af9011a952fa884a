// Prints how often a second the processor's counter ticks (1e9 when it is not used): LinuxCNC tells times in these ticks.
#include <cstdio>

#include "rtapi/clock/cycle_counter.hpp"

int main() { std::printf("%.0f\n", kerf::rtapi::CycleCounter::calibrated().frequency_hz()); }
