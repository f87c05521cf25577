// Tests the fake's URScript, on which all results about the driver's program depend.
#include "fakes/ur/urscript.h"

#include <gtest/gtest.h>

#include <string>

#include "fakes/ur/urscript_machine.h"

namespace predictor {
namespace {

// Executes a program with this body for some cycles. The controller holds the output.
UrController Play(const std::string& body, int cycles = 10) {
  UrController controller;
  controller.input_double[3] = 2.5;
  controller.input_int[4] = -7;
  const auto program = urscript::Compile("def test():\n" + body + "\nend\n");
  urscript::Machine machine(&program, &controller);
  for (int i = 0; i < cycles && machine.Cycle(); ++i) controller.Advance();
  return controller;
}

double Result(const std::string& expression) {
  return Play("write_output_float_register(0, " + expression + ")").output_double[0];
}

std::string ErrorOf(const std::string& body) {
  try {
    Play(body);
  } catch (const urscript::Error& error) {
    return error.what();
  }
  return "";
}

TEST(UrScriptLanguage, Arithmetic) {
  EXPECT_EQ(Result("1 + 2 * 3 - 4 / 8"), 6.5);
  EXPECT_EQ(Result("(1 + 2) * -3"), -9);
  EXPECT_EQ(Result("7 % 4"), 3);
  EXPECT_EQ(Result("10 - 3 - 2"), 5);
  EXPECT_EQ(Result("[1, [2, 3], 4][1][0]"), 2);
}

TEST(UrScriptLanguage, Conditions) {
  const auto truth = [](const std::string& condition) {
    return Play("if " + condition + ":\nwrite_output_integer_register(0, 1)\nend").output_int[0] ==
           1;
  };
  EXPECT_TRUE(truth("1 < 2 and not 2 < 1"));
  EXPECT_TRUE(truth("False or 1 == 1"));
  EXPECT_TRUE(truth("True or False and False"));
  EXPECT_FALSE(truth("not (1 <= 1)"));
  EXPECT_TRUE(truth("2 != 3 and 3 >= 3 and 4 > 3"));
  EXPECT_TRUE(truth("[1, 2] == [1, 2]"));
  // The evaluation ends as soon as the result is known.
  EXPECT_FALSE(truth("False and 1 / 0 > 1"));
  EXPECT_TRUE(truth("True or 1 / 0 > 1"));
}

TEST(UrScriptLanguage, BranchesAndLoops) {
  const std::string branches = R"(
    i = 0
    sum = 0
    while True:
      i = i + 1
      if i == 3:
        continue
      elif i > 6:
        break
      else:
        sum = sum + i
      end
    end
    write_output_integer_register(0, sum))";
  EXPECT_EQ(Play(branches).output_int[0], 1 + 2 + 4 + 5 + 6);
}

TEST(UrScriptLanguage, FunctionsHaveLocalsAndSeeGlobals) {
  const std::string text = R"(
    global g = 10
    x = 1
    def f(a, b):
      x = a * b
      g = g + x
      return x
    end
    write_output_integer_register(0, f(2, 3) + f(1, 1))
    write_output_integer_register(1, g)
    write_output_integer_register(2, x))";
  const auto controller = Play(text);
  EXPECT_EQ(controller.output_int[0], 7);
  EXPECT_EQ(controller.output_int[1], 17);
  EXPECT_EQ(controller.output_int[2], 1);
}

TEST(UrScriptLanguage, ListsAreCopied) {
  const auto controller = Play(
      "a = [1, 2, 3]\nb = a\nb[1] = 9\nwrite_output_integer_register(0, a[1])\n"
      "write_output_integer_register(1, b[1])");
  EXPECT_EQ(controller.output_int[0], 2);
  EXPECT_EQ(controller.output_int[1], 9);
}

TEST(UrScriptLanguage, RegistersAreThoseOfTheController) {
  EXPECT_EQ(Result("read_input_float_register(3)"), 2.5);
  EXPECT_EQ(Result("read_input_integer_register(4)"), -7);
}

TEST(UrScriptLanguage, SyncWaitsForTheNextCycle) {
  const std::string text = R"(
    n = 0
    while True:
      n = n + 1
      write_output_integer_register(0, n)
      sync()
    end)";
  EXPECT_EQ(Play(text, 7).output_int[0], 7);
}

TEST(UrScriptLanguage, ThreadsRunUntilTheyWaitAndDieWithTheProgramOrWhenKilled) {
  const std::string text = R"(
    global n = 0
    thread count():
      while True:
        n = n + 1
        write_output_integer_register(0, n)
        sync()
      end
    end
    handle = run count()
    sleep(0.008)
    kill handle
    sleep(0.008)
    other = run count()
    sync()
    write_output_integer_register(1, 1))";
  const auto controller = Play(text, 50);
  EXPECT_EQ(controller.output_int[0], 4 + 1);  // four cycles of two milliseconds, plus one
  EXPECT_EQ(controller.output_int[1], 1);
}

TEST(UrScriptLanguage, JoinWaitsForAThread) {
  const std::string text = R"(
    thread wait():
      sleep(0.01)
      write_output_integer_register(0, 5)
    end
    join run wait()
    write_output_integer_register(1, 6))";
  EXPECT_EQ(Play(text, 5).output_int[1], 0);
  EXPECT_EQ(Play(text, 8).output_int[0], 5);
  EXPECT_EQ(Play(text, 8).output_int[1], 6);
}

// The leading joint moves with v(t) = min(a t, |qd|), and the others in proportion.
TEST(UrScriptLanguage, SpeedjAcceleratesTheLeadingJointAndBlocksForItsTime) {
  const std::string text =
      "speedj([0.1, -0.2, 0, 0, 0, 0], 5, 0.02)\n"
      "write_output_integer_register(0, 1)\nsync()\nwhile True:\nsync()\nend";
  for (int cycles = 1; cycles < 40; ++cycles) {
    const auto controller = Play(text, cycles);
    const double expected = std::min(0.2, 5 * 0.002 * cycles);
    EXPECT_NEAR(controller.set_point()[1], -expected, 1e-12) << cycles;
    EXPECT_NEAR(controller.set_point()[0], expected / 2, 1e-12) << cycles;
    EXPECT_EQ(controller.output_int[0], cycles > 10 ? 1 : 0) << cycles;
  }
}

TEST(UrScriptLanguage, StopjBrakesAndBlocksUntilStandstill) {
  const std::string text =
      "speedj([0.1, 0, 0, 0, 0, 0], 50, 0.002)\nstopj(5)\n"
      "write_output_integer_register(0, 1)";
  EXPECT_EQ(Play(text, 10).output_int[0], 0);
  EXPECT_GT(Play(text, 10).set_point()[0], 0);
  EXPECT_EQ(Play(text, 15).output_int[0], 1);
  EXPECT_EQ(Play(text, 15).set_point()[0], 0);
}

TEST(UrScriptLanguage, UnknownNamesAreErrors) {
  EXPECT_NE(ErrorOf("movej([0,0,0,0,0,0])").find("line 2: unknown function 'movej'"),
            std::string::npos);
  EXPECT_NE(ErrorOf("x = y").find("unknown variable 'y'"), std::string::npos);
  EXPECT_NE(ErrorOf("x = 1 ; y = 2").find("unknown symbol ';'"), std::string::npos);
  EXPECT_NE(ErrorOf("run f()").find("unknown function 'f'"), std::string::npos);
  EXPECT_NE(ErrorOf("def f():\nend\nrun f()").find("unknown function 'f'"), std::string::npos);
  EXPECT_NE(ErrorOf("sync(1)").find("wrong number of arguments"), std::string::npos);
  EXPECT_NE(ErrorOf("def f(a):\nend\nf()").find("wrong number of arguments"), std::string::npos);
  EXPECT_NE(ErrorOf("if 1:\nend").find("wrong type"), std::string::npos);
  EXPECT_NE(ErrorOf("x = 1 +").find("a name was expected"), std::string::npos);
  EXPECT_NE(ErrorOf("while True\nend").find("':' expected"), std::string::npos);
  EXPECT_NE(ErrorOf("if True:").find("a block has no end"), std::string::npos);
  EXPECT_NE(ErrorOf("x = [1][1]").find("out of range"), std::string::npos);
  EXPECT_NE(ErrorOf("read_input_float_register(48)").find("out of range"), std::string::npos);
  EXPECT_NE(ErrorOf("speedj([1, 2], 1, 1)").find("six joints"), std::string::npos);
  EXPECT_NE(ErrorOf("x = 1 / 0").find("division by zero"), std::string::npos);
  EXPECT_NE(ErrorOf("break").find("outside of a loop"), std::string::npos);
}

TEST(UrScriptLanguage, ThreadThatNeverWaitsIsAnError) {
  EXPECT_NE(ErrorOf("while True:\nx = 1\nend").find("without waiting"), std::string::npos);
}

TEST(UrScriptLanguage, TwoThreadsThatMoveTheArmAreAnError) {
  const std::string text = R"(
    thread move():
      speedj([1, 0, 0, 0, 0, 0], 1, 1)
    end
    run move()
    sync()
    stopj(1))";
  EXPECT_NE(ErrorOf(text).find("already controlling"), std::string::npos);
}

TEST(UrScriptLanguage, ProgramIsCompleteAtItsLastEnd) {
  const std::string text = "def f():\n  if True:\n    sync()\n  end\nend\n";
  for (std::size_t size = 0; size < text.size(); ++size)
    EXPECT_FALSE(urscript::Complete(text.substr(0, size))) << size;
  EXPECT_TRUE(urscript::Complete(text));
}

}  // namespace
}  // namespace predictor
