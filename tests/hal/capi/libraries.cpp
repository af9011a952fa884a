// The libraries for programs beside HAL's: INI files and posemath, in C++.
#include <posemath.h>
#include <inifile.hh>

#include <cstdio>

int main(int argc, char** argv) {
  IniFile ini;
  if (argc < 2 || !ini.Open(argv[1])) return 2;
  int line = 0;
  const char* second = ini.Find("X", "A", 2, &line);
  std::printf("%s in line %d\n", second, line);
  int i = 0;
  double d = 0;
  std::string s;
  int found = ini.Find(&i, "I", "A");
  std::printf("%d %d", found, i);
  found = ini.Find(&d, "D", "A");
  std::printf(" %d %g", found, d);
  found = ini.Find(&s, "X", "A");
  std::printf(" %d %s", found, s.c_str());
  std::printf(" %d %d %d\n", ini.Find(&i, "X", "A"), ini.Find(&i, "N", "A"),
              ini.Find(&i, "I", "C"));
  std::printf("%d %d\n", ini.Find(&i, 0, 3, "I", "A"), ini.Find(&i, 0, 9, "I", "A"));
  const PM_CARTESIAN a(1, 2, 3);
  const PM_POSE p(a, PM_QUATERNION(PM_Z, PM_PI_2));
  const PM_CARTESIAN there = p * PM_CARTESIAN(1, 0, 0);
  std::printf("%g %g %g, back %d\n", there.x, there.y, there.z,
              p * inv(p) == PM_POSE(0, 0, 0, 1, 0, 0, 0));
}
