/* An INI file, for programs in C++: link with -llinuxcncini.

     IniFile ini;
     if (!ini.Open("machine.ini")) ...
     const char* units = ini.Find("LINEAR_UNITS", "TRAJ");
*/
#ifndef INIFILE_HH
#define INIFILE_HH

#include <inifile.h>

#include <strings.h>

#include <cstring>
#include <string>

class IniFile {
 public:
  enum ErrorCode {
    ERR_NONE = 0x00,
    ERR_NOT_OPEN = 0x01,
    ERR_SECTION_NOT_FOUND = 0x02,
    ERR_TAG_NOT_FOUND = 0x04,
    ERR_CONVERSION = 0x08,
    ERR_LIMITS = 0x10,
    ERR_OVER_EXTENDED = 0x20,
  };

  IniFile() = default;
  /* The file stays the caller's. `errors` is not used: errors are what functions give. */
  explicit IniFile(int errors, FILE* file = nullptr) : file_(file) { (void)errors; }
  ~IniFile() { Close(); }
  IniFile(const IniFile&) = delete;
  IniFile& operator=(const IniFile&) = delete;

  bool Open(const char* name) {
    Close();
    file_ = std::fopen(name, "re");
    own_ = file_ != nullptr;
    return own_;
  }
  bool Close() {
    const bool ok = !own_ || std::fclose(file_) == 0;
    file_ = nullptr;
    own_ = false;
    return ok;
  }
  bool IsOpen() const { return file_ != nullptr; }

  /* The num-th value, or NULL. It stays until the thread's next call. */
  const char* Find(const char* tag, const char* section, int num = 1, int* line = nullptr) const {
    return file_ == nullptr ? nullptr : iniFindNth(file_, tag, section, num, line);
  }
  ErrorCode Find(std::string* result, const char* tag, const char* section, int num = 1,
                 int* line = nullptr) const {
    const char* text = Find(tag, section, num, line);
    if (text == nullptr) return why_not(section);
    *result = text;
    return ERR_NONE;
  }
  ErrorCode Find(int* result, const char* tag, const char* section, int num = 1,
                 int* line = nullptr) const {
    return number(tag, section, num, line, "%i%c", result);
  }
  ErrorCode Find(double* result, const char* tag, const char* section, int num = 1,
                 int* line = nullptr) const {
    return number(tag, section, num, line, "%lf%c", result);
  }
  /* Only what is between the two. */
  template <class T>
  ErrorCode Find(T* result, T least, T most, const char* tag, const char* section, int num = 1,
                 int* line = nullptr) const {
    T value;
    const ErrorCode found = Find(&value, tag, section, num, line);
    if (found != ERR_NONE) return found;
    if (value < least || value > most) return ERR_LIMITS;
    *result = value;
    return ERR_NONE;
  }
  /* Words that stand for numbers; the last has a name of NULL. */
  struct StrIntPair {
    const char* pStr;
    int value;
  };
  struct StrDoublePair {
    const char* pStr;
    double value;
  };
  ErrorCode Find(int* result, StrIntPair* words, const char* tag, const char* section, int num = 1,
                 int* line = nullptr) const {
    return word(result, words, tag, section, num, line);
  }
  ErrorCode Find(double* result, StrDoublePair* words, const char* tag, const char* section,
                 int num = 1, int* line = nullptr) const {
    return word(result, words, tag, section, num, line);
  }
  ErrorCode FindString(char* room, size_t size, const char* tag, const char* section, int num = 1,
                       int* line = nullptr) const {
    const char* text = Find(tag, section, num, line);
    if (text == nullptr) return why_not(section);
    if (std::strlen(text) >= size) return ERR_OVER_EXTENDED;
    std::strcpy(room, text);
    return ERR_NONE;
  }
  /* With "~/" expanded. */
  ErrorCode FindPath(char* room, size_t size, const char* tag, const char* section, int num = 1,
                     int* line = nullptr) const {
    const char* text = Find(tag, section, num, line);
    if (text == nullptr) return why_not(section);
    const std::string whole = text;
    return TildeExpansion(whole.c_str(), room, size);
  }
  static ErrorCode TildeExpansion(const char* file, char* path, size_t size) {
    return ::TildeExpansion(file, path, size) != 0 ? ERR_NONE : ERR_OVER_EXTENDED;
  }

 private:
  ErrorCode why_not(const char* section) const {
    if (file_ == nullptr) return ERR_NOT_OPEN;
    if (section != nullptr && iniHasSection(file_, section) == 0) return ERR_SECTION_NOT_FOUND;
    return ERR_TAG_NOT_FOUND;
  }
  template <class T>
  ErrorCode number(const char* tag, const char* section, int num, int* line, const char* format,
                   T* result) const {
    const char* text = Find(tag, section, num, line);
    if (text == nullptr) return why_not(section);
    T value;
    char rest;
    if (std::sscanf(text, format, &value, &rest) != 1) return ERR_CONVERSION;
    *result = value;
    return ERR_NONE;
  }
  template <class Pair, class T>
  ErrorCode word(T* result, const Pair* words, const char* tag, const char* section, int num,
                 int* line) const {
    const char* text = Find(tag, section, num, line);
    if (text == nullptr) return why_not(section);
    for (; words->pStr != nullptr; ++words) {
      if (strcasecmp(text, words->pStr) != 0) continue;
      *result = words->value;
      return ERR_NONE;
    }
    return ERR_CONVERSION;
  }

  FILE* file_ = nullptr;
  bool own_ = false;
};

#endif
