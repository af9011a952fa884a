// The plain path (numbers, moves) takes no memory from the heap once it is warm.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>
#include <string>

#include "interp/interpreter.hpp"
#include "interp/null_canon.hpp"

namespace {
unsigned long allocations = 0;  // single-threaded test program
}  // namespace

[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace kerf::interp {
namespace {

TEST(Allocation, PlainLinesAndLoopsNeedNone) {
  std::string program = "F1000\n";
  for (int i = 0; i < 2000; ++i) {
    const std::string number =
        std::to_string(i);  // appended piecewise: g++ 12 warns wrongly about "x" + string
    program.append(1, 'N').append(number).append(" G1 X").append(number);
    program.append(".25 Y[1+2] (c)\nG2 X5 Y5 R5000\nG0 X0 Y0\n");
  }
  program += "#1=0\no1 while [#1 lt 3000]\n#1=[#1+1]\nG1 X[sin[#1]] Y#1\no1 endwhile\nM2\n";
  Environment world;
  NullCanon canon;
  Interpreter interp(world, canon);
  interp.init();
  ASSERT_TRUE(interp.open_text("plain", program).ok());
  for (int i = 0; i < 20; ++i) ASSERT_EQ(interp.execute_next(), Outcome::ok);
  unsigned long before = allocations;
  for (int i = 0; i < 5900; ++i) ASSERT_EQ(interp.execute_next(), Outcome::ok);
  EXPECT_EQ(allocations - before, 0U) << "straight lines and arcs";
  for (int i = 0; i < 200; ++i) ASSERT_EQ(interp.execute_next(), Outcome::ok);
  before = allocations;
  for (int i = 0; i < 9000; ++i) ASSERT_EQ(interp.execute_next(), Outcome::ok);
  EXPECT_EQ(allocations - before, 0U) << "turns of a loop";
}

TEST(Allocation, CallsAndBranchesNeedNone) {
  const std::string program =
      "o<leaf> sub\n#<sum>=[#1+#2+#<_g>]\n#<_g>=#<sum>\no<leaf> return [#<sum>]\no<leaf> endsub\n"
      "o<middle> sub\no1 repeat [2]\no<leaf> call [#1] [2]\no1 endrepeat\no<middle> endsub\n"
      "#<_g>=0\n#<turn>=0\no2 while [1]\n#<turn>=[#<turn>+1]\no3 if [#<turn> gt 1000000]\n"
      "o3 elseif [#<turn> mod 2]\no<middle> call [#<turn>] [5] [6]\no3 else\n#<_g>=0\no3 endif\n"
      "o4 do\no4 while [0]\no2 endwhile\nM2\n";
  Environment world;
  NullCanon canon;
  Interpreter interp(world, canon);
  interp.init();
  ASSERT_TRUE(interp.open_text("calls", program).ok());
  for (int i = 0; i < 300; ++i) ASSERT_EQ(interp.execute_next(), Outcome::ok);
  const unsigned long before = allocations;
  for (int i = 0; i < 20000; ++i) ASSERT_EQ(interp.execute_next(), Outcome::ok);
  EXPECT_EQ(allocations - before, 0U);
}

}  // namespace
}  // namespace kerf::interp
