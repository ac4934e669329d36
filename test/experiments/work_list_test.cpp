// Tests E6. Who has which task.
#include "experiments/farm/work_list.h"

#include <gmock/gmock.h>

#include <stdexcept>

namespace vismem {
namespace {

WorkList twoTasks() {
  WorkList list;
  list.add({{"a", "text a", ""}, {"b", "text b", "half of b"}});
  return list;
}

TEST(WorkList, GivesEachTaskOutOnce) {
  WorkList list = twoTasks();
  list.add({{"a", "another text", ""}});
  EXPECT_EQ(list.take()->text, "text a");
  EXPECT_EQ(list.take()->parts, "half of b");
  EXPECT_FALSE(list.take());
  list.finish("a");
  list.finish("b");
  EXPECT_THROW(list.finish("b"), std::invalid_argument);
}

TEST(WorkList, ALostTaskIsTheNextOneWithTheParts) {
  WorkList list = twoTasks();
  list.take();
  list.keepParts("a", "half of a");
  list.lose("a");
  EXPECT_EQ(list.losses(), 1);
  const auto again = list.take();
  ASSERT_TRUE(again);
  EXPECT_EQ(again->name, "a");
  EXPECT_EQ(again->parts, "half of a");
  list.giveBack("a");
  EXPECT_EQ(list.take()->name, "a");
  EXPECT_EQ(list.losses(), 1);
}

TEST(WorkList, ATaskThatWorkersDieOfEndsTheRun) {
  WorkList list = twoTasks();
  for (int i = 1; i < WorkList::kMostLosses; ++i) {
    list.take();
    list.lose("a");
  }
  list.take();
  try {
    list.lose("a");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "task a: 20 workers died of it");
  }
}

TEST(WorkList, AFinishedTaskIsNotGivenOutAgain) {
  WorkList list = twoTasks();
  list.take();
  list.lose("a");
  // A worker that was thought dead has done it.
  list.finish("a");
  EXPECT_EQ(list.take()->name, "b");
  EXPECT_FALSE(list.take());
}

}  // namespace
}  // namespace vismem
