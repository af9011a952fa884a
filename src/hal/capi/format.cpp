#include "hal/capi/format.hpp"

#include <cstdint>
#include <cstring>

namespace kerf::hal::capi {
namespace {

struct Sink {
  char* buffer;
  std::size_t size;
  std::size_t wanted{0};
  void put(char c) noexcept {
    if (wanted + 1 < size) buffer[wanted] = c;
    ++wanted;
  }
  void put(const char* text, std::size_t n) noexcept {
    for (std::size_t i = 0; i < n; ++i) put(text[i]);
  }
  void fill(char c, int n) noexcept {
    for (; n > 0; --n) put(c);
  }
};

struct Spec {
  bool left{false}, plus{false}, space{false}, alternate{false}, zero{false};
  int width{0};
  int precision{-1};
};

/// Sign or prefix, zeros, then digits, in a field.
void put_number(Sink& out, const Spec& spec, const char* prefix, int prefix_n, int zeros,
                const char* digits, int n) noexcept {
  int pad = spec.width - prefix_n - zeros - n;
  if (!spec.left && spec.zero) {
    zeros += pad > 0 ? pad : 0;
    pad = 0;
  }
  if (!spec.left) out.fill(' ', pad);
  out.put(prefix, static_cast<std::size_t>(prefix_n));
  out.fill('0', zeros);
  out.put(digits, static_cast<std::size_t>(n));
  if (spec.left) out.fill(' ', pad);
}

void put_integer(Sink& out, Spec spec, std::uint64_t value, bool negative, bool is_signed,
                 unsigned base, bool upper, bool pointer) noexcept {
  char digits[24];
  int n = 0;
  const bool is_zero = value == 0;
  const char* letters = upper ? "0123456789ABCDEF" : "0123456789abcdef";
  char* const end = digits + sizeof digits;
  char* at = end;
  for (; value > 0 || n == 0; value /= base, ++n) *--at = letters[value % base];
  if (spec.precision == 0 && is_zero) n = 0;
  char prefix[2];
  int prefix_n = 0;
  if (is_signed) {
    const char sign = negative ? '-' : spec.plus ? '+' : spec.space ? ' ' : '\0';
    if (sign != '\0') prefix[prefix_n++] = sign;
  } else if (base == 16 && (pointer || (spec.alternate && !is_zero))) {
    prefix[prefix_n++] = '0';
    prefix[prefix_n++] = upper ? 'X' : 'x';
  }
  int zeros = spec.precision > n ? spec.precision - n : 0;
  if (base == 8 && spec.alternate && zeros == 0 && (!is_zero || n == 0)) zeros = 1;
  if (spec.precision >= 0) spec.zero = false;
  put_number(out, spec, prefix, prefix_n, zeros, end - n, n);
}

/// All decimal digits of a finite number that are asked for, exactly.
class Decimal {
 public:
  static constexpr int kWords = 36;  ///< 32-bit words that hold 2^1024 or a fraction of 1074 bits
  static constexpr int kDigits = 800;

  explicit Decimal(double value) noexcept {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    int exponent = static_cast<int>((bits >> 52U) & 0x7ffU);
    std::uint64_t mantissa = bits & ((std::uint64_t{1} << 52U) - 1);
    if (exponent == 0)
      exponent = 1;
    else
      mantissa |= std::uint64_t{1} << 52U;
    exponent -= 1075;
    if (exponent >= 0) {
      whole(mantissa, exponent);
    } else {
      const int k = -exponent;
      whole(k < 64 ? mantissa >> static_cast<unsigned>(k) : 0, 0);
      const std::uint64_t rest =
          k < 64 ? mantissa & ((std::uint64_t{1} << static_cast<unsigned>(k)) - 1) : mantissa;
      // The fraction rest / 2^k as fraction_ / 2^(32 * fraction_words_), the highest word first.
      fraction_words_ = (k + 31) / 32;
      const int up = fraction_words_ * 32 - k;
      for (int bit = 0; bit < 64; ++bit) {
        if (((rest >> static_cast<unsigned>(bit)) & 1U) == 0) continue;
        const int at = bit + up;
        const int word = fraction_words_ - 1 - at / 32;
        if (word >= 0) fraction_[word] |= std::uint32_t{1} << static_cast<unsigned>(at % 32);
      }
    }
  }

  /// Makes `n` digits behind the point; false: something but zeros follows that is not there.
  void fraction_digits(int n) noexcept {
    while (count_ - point_ < n && count_ + 9 <= kDigits) {
      std::uint64_t carry = 0;
      for (int i = fraction_words_ - 1; i >= 0; --i) {
        const std::uint64_t v = std::uint64_t{fraction_[i]} * 1'000'000'000U + carry;
        fraction_[i] = static_cast<std::uint32_t>(v);
        carry = v >> 32U;
      }
      put_chunk(static_cast<std::uint32_t>(carry), true);
    }
  }
  /// Keeps the first `n` digits, rounded half to even. A carry out of the front adds a digit there and moves the point.
  void round_to(int n) noexcept {
    if (n < 0) {
      count_ = 0;
      return;
    }
    if (n >= count_) return;
    bool rest = false;
    for (int i = n + 1; i < count_; ++i) rest = rest || digit_[i] != '0';
    for (int i = 0; i < fraction_words_; ++i) rest = rest || fraction_[i] != 0;
    const bool odd = n > 0 && (digit_[n - 1] - '0') % 2 == 1;
    const bool up = digit_[n] > '5' || (digit_[n] == '5' && (rest || odd));
    count_ = n;
    if (!up) return;
    int i = n - 1;
    for (; i >= 0 && digit_[i] == '9'; --i) digit_[i] = '0';
    if (i >= 0) {
      ++digit_[i];
      return;
    }
    std::memmove(digit_ + 1, digit_, static_cast<std::size_t>(n));
    digit_[0] = '1';
    ++count_;
    ++point_;
  }
  /// Position of the first digit that is not 0; count() when there is none.
  [[nodiscard]] int first() const noexcept {
    int i = 0;
    while (i < count_ && digit_[i] == '0') ++i;
    return i;
  }
  [[nodiscard]] bool fraction_is_zero() const noexcept {
    for (int i = 0; i < fraction_words_; ++i)
      if (fraction_[i] != 0) return false;
    return true;
  }
  [[nodiscard]] char digit(int i) const noexcept { return i >= 0 && i < count_ ? digit_[i] : '0'; }
  [[nodiscard]] int count() const noexcept { return count_; }
  /// Digits before the point.
  [[nodiscard]] int point() const noexcept { return point_; }

 private:
  void whole(std::uint64_t value, int shift) noexcept {
    std::uint32_t words[kWords]{};  // the lowest first
    const int word = shift / 32;
    const auto bits = static_cast<unsigned>(shift % 32);
    const std::uint64_t low = value << bits;
    words[word] = static_cast<std::uint32_t>(low);
    words[word + 1] = static_cast<std::uint32_t>(low >> 32U);
    if (bits > 0) words[word + 2] = static_cast<std::uint32_t>(value >> (64U - bits));
    std::uint32_t chunks[kWords];
    int n = 0;
    for (int top = word + 2; top >= 0;) {
      if (words[top] == 0) {
        --top;
        continue;
      }
      std::uint64_t rest = 0;
      for (int i = top; i >= 0; --i) {
        const std::uint64_t v = (rest << 32U) | words[i];
        words[i] = static_cast<std::uint32_t>(v / 1'000'000'000U);
        rest = v % 1'000'000'000U;
      }
      chunks[n++] = static_cast<std::uint32_t>(rest);
    }
    if (n == 0) digit_[count_++] = '0';
    for (int i = n - 1; i >= 0; --i) put_chunk(chunks[i], i != n - 1);
    point_ = count_;
  }
  void put_chunk(std::uint32_t chunk, bool all_nine) noexcept {
    char text[9];
    for (int i = 8; i >= 0; --i, chunk /= 10) text[i] = static_cast<char>('0' + chunk % 10);
    int from = 0;
    while (!all_nine && from < 8 && text[from] == '0') ++from;
    for (; from < 9; ++from) digit_[count_++] = text[from];
  }
  std::uint32_t fraction_[kWords]{};
  int fraction_words_{0};
  char digit_[kDigits + 10]{};
  int count_{0};
  int point_{0};
};

void put_float(Sink& out, Spec spec, double value, char conversion) noexcept {
  const bool upper = conversion >= 'A' && conversion <= 'Z';
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  const bool negative = (bits >> 63U) != 0;
  char sign = negative ? '-' : spec.plus ? '+' : spec.space ? ' ' : '\0';
  const int sign_n = sign == '\0' ? 0 : 1;
  if (((bits >> 52U) & 0x7ffU) == 0x7ffU) {
    const bool is_nan = (bits & ((std::uint64_t{1} << 52U) - 1)) != 0;
    spec.zero = false;
    put_number(out, spec, &sign, sign_n, 0,
               is_nan ? (upper ? "NAN" : "nan") : (upper ? "INF" : "inf"), 3);
    return;
  }
  int precision = spec.precision < 0 ? 6 : spec.precision;
  if (precision > kMostPrecision) precision = kMostPrecision;
  Decimal d(value);
  char text[Decimal::kDigits + 20];
  int n = 0;
  const char kind = static_cast<char>(conversion | 0x20);
  const bool general = kind == 'g' || kind == 'a';
  bool scientific = kind == 'e';
  int keep = precision;  // digits behind the point
  int exponent = 0;
  if (general || scientific) {
    // Significant digits: enough of the fraction to find the first one and all that follow.
    const int significant = general ? (precision == 0 ? 1 : precision) : precision + 1;
    d.fraction_digits(1);
    while (d.first() == d.count() && !d.fraction_is_zero())
      d.fraction_digits(d.count() - d.point() + 9);
    const bool is_zero = d.first() == d.count();
    const int first = is_zero ? d.point() - 1 : d.first();
    d.fraction_digits(first + significant - d.point() + 1);
    const int point = d.point();
    d.round_to(first + significant);
    // A carry out of the first digit either made a new digit in front (the point moved) or turned a leading zero into a one.
    int lead = first;
    if (!is_zero) lead = d.first();
    exponent = d.point() - 1 - lead;
    (void)point;
    if (general) {
      scientific = exponent < -4 || exponent >= significant;
      keep = scientific ? significant - 1 : significant - 1 - exponent;
    }
    if (scientific) {
      text[n++] = d.digit(lead);
      int last = keep;
      if (general && !spec.alternate)
        while (last > 0 && d.digit(lead + last) == '0') --last;
      if (last > 0 || spec.alternate) text[n++] = '.';
      for (int i = 1; i <= last; ++i) text[n++] = d.digit(lead + i);
      text[n++] = upper ? 'E' : 'e';
      text[n++] = exponent < 0 ? '-' : '+';
      const int size = exponent < 0 ? -exponent : exponent;
      if (size >= 100) text[n++] = static_cast<char>('0' + size / 100);
      text[n++] = static_cast<char>('0' + size / 10 % 10);
      text[n++] = static_cast<char>('0' + size % 10);
      put_number(out, spec, &sign, sign_n, 0, text, n);
      return;
    }
  } else {
    d.fraction_digits(keep + 1);
    d.round_to(d.point() + keep);
  }
  int from = 0;
  while (from < d.point() - 1 && d.digit(from) == '0') ++from;
  for (int i = from; i < d.point(); ++i) text[n++] = d.digit(i);
  int last = keep;
  if (general && !spec.alternate)
    while (last > 0 && d.digit(d.point() + last - 1) == '0') --last;
  if (last > 0 || spec.alternate) text[n++] = '.';
  for (int i = 0; i < last; ++i) text[n++] = d.digit(d.point() + i);
  put_number(out, spec, &sign, sign_n, 0, text, n);
}

int parse_number(const char*& p) noexcept {
  int value = 0;
  for (; *p >= '0' && *p <= '9'; ++p)
    if (value < 10000) value = value * 10 + (*p - '0');
  return value;
}

}  // namespace

int format_text(char* buffer, std::size_t size, const char* fmt, std::va_list args) noexcept {
  Sink out{buffer, size};
  std::va_list ap;
  va_copy(ap, args);
  for (const char* p = fmt; *p != '\0'; ++p) {
    if (*p != '%') {
      out.put(*p);
      continue;
    }
    const char* const begin = p++;
    Spec spec;
    for (bool more = true; more;) {
      switch (*p) {
        case '-': spec.left = true; break;
        case '+': spec.plus = true; break;
        case ' ': spec.space = true; break;
        case '#': spec.alternate = true; break;
        case '0': spec.zero = true; break;
        default: more = false; break;
      }
      if (more) ++p;
    }
    if (*p == '*') {
      spec.width = va_arg(ap, int);
      ++p;
      if (spec.width < 0) {
        spec.left = true;
        spec.width = -spec.width;
      }
    } else {
      spec.width = parse_number(p);
    }
    if (*p == '.') {
      ++p;
      if (*p == '*') {
        spec.precision = va_arg(ap, int);
        ++p;
      } else {
        spec.precision = parse_number(p);
      }
    }
    int length = 0;  // -2 hh, -1 h, 0, 1 l and everything of 64 bits
    bool long_double = false;
    for (;; ++p) {
      if (*p == 'h')
        --length;
      else if (*p == 'l' || *p == 'q' || *p == 'j' || *p == 'z' || *p == 't')
        length = 1;
      else if (*p == 'L')
        long_double = true;
      else
        break;
    }
    switch (*p) {
      case 'd':
      case 'i': {
        std::int64_t v = 0;
        if (length > 0)
          v = va_arg(ap, long);
        else
          v = va_arg(ap, int);
        if (length == -1) v = static_cast<short>(v);
        if (length <= -2) v = ((v & 0xff) ^ 0x80) - 0x80;  // the low byte with its sign
        const std::uint64_t magnitude =
            v < 0 ? 0 - static_cast<std::uint64_t>(v) : static_cast<std::uint64_t>(v);
        put_integer(out, spec, magnitude, v < 0, true, 10, false, false);
        break;
      }
      case 'u':
      case 'o':
      case 'x':
      case 'X': {
        std::uint64_t v = 0;
        if (length > 0)
          v = va_arg(ap, unsigned long);
        else
          v = va_arg(ap, unsigned);
        if (length == -1) v = static_cast<unsigned short>(v);
        if (length <= -2) v = static_cast<unsigned char>(v);
        put_integer(out, spec, v, false, false,
                    *p == 'u'   ? 10
                    : *p == 'o' ? 8
                                : 16,
                    *p == 'X', false);
        break;
      }
      case 'p': {
        const auto v = reinterpret_cast<std::uintptr_t>(va_arg(ap, void*));
        if (v == 0)
          put_number(out, spec, "", 0, 0, "(nil)", 5);
        else
          put_integer(out, spec, v, false, false, 16, false, true);
        break;
      }
      case 'c': {
        const char c = static_cast<char>(va_arg(ap, int));
        spec.zero = false;
        put_number(out, spec, "", 0, 0, &c, 1);
        break;
      }
      case 's': {
        const char* s = va_arg(ap, const char*);
        if (s == nullptr) s = "(null)";
        int n = 0;
        while ((spec.precision < 0 || n < spec.precision) && s[n] != '\0') ++n;
        spec.zero = false;
        put_number(out, spec, "", 0, 0, s, n);
        break;
      }
      case 'a':
      case 'A':
      case 'e':
      case 'E':
      case 'f':
      case 'F':
      case 'g':
      case 'G': {
        const double v =
            long_double ? static_cast<double>(va_arg(ap, long double)) : va_arg(ap, double);
        put_float(out, spec, v, *p);
        break;
      }
      case '%': out.put('%'); break;
      default:
        // Not a conversion of ours: as it stands, so that the reader sees what was meant.
        out.put(begin, static_cast<std::size_t>(p - begin) + (*p != '\0' ? 1U : 0U));
        if (*p == '\0') --p;
        break;
    }
  }
  va_end(ap);
  if (size > 0) buffer[out.wanted < size ? out.wanted : size - 1] = '\0';
  return static_cast<int>(out.wanted);
}

}  // namespace kerf::hal::capi
