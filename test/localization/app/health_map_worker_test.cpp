// Tests L10.
#include "localization/app/health_map_worker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <mutex>

#include "common/geometry/angles.h"
#include "localization/map_views.h"

namespace vismem {
namespace {

using testing::HasSubstr;

SegmentMap oneWall() {
  SegmentMap map;
  map.segments = {{{{0, 0, 0}, {3, 0, 0}}, "skirting", 0.0}, {{{0, 0, 0}, {0, 2, 0}}, "skirting", 0.0}};
  return map;
}

HealthMapRequest coarse() {
  HealthMapRequest request;
  request.cell_m = 0.5;
  request.headings = 4;
  return request;
}

struct Answer {
  std::optional<HealthMap> map;
  std::string why;
};

/// Requests a map. The future has the answer.
std::future<Answer> draw(HealthMapWorker& worker, const HealthMapRequest& request) {
  auto promise = std::make_shared<std::promise<Answer>>();
  const PortReply reply =
      worker.draw(request, [promise](std::optional<HealthMap> map, const std::string& why) {
        promise->set_value({std::move(map), why});
      });
  if (!reply.ok()) promise->set_value({std::nullopt, "rejected: " + reply.message});
  return promise->get_future();
}

MemoryUpdate view() {
  return test::viewFrom(oneWall(), {1.5, 1.5, degToRad(-90)}, kSecondUs, 0.0, degToRad(-20));
}

TEST(HealthMapWorker, AnswersWithAMapOfTheNewestObservation) {
  HealthMapWorker worker({}, oneWall(), view);
  const Answer answer = draw(worker, coarse()).get();
  ASSERT_TRUE(answer.map) << answer.why;
  EXPECT_EQ(answer.map->stamp_us, kSecondUs);
  EXPECT_EQ(answer.map->columns, 7);
  EXPECT_EQ(answer.map->rows, 5);
}

TEST(HealthMapWorker, GivesTheReasonWithoutAnObservation) {
  HealthMapWorker worker({}, oneWall(), [] { return MemoryUpdate{}; });
  EXPECT_EQ(draw(worker, coarse()).get().why, "no observation yet");
}

TEST(HealthMapWorker, GivesTheReasonWithoutACommonLabel) {
  SegmentMap other = oneWall();
  for (MapSegment& segment : other.segments) segment.label = "shelf";
  HealthMapWorker worker({}, other, view);
  EXPECT_THAT(draw(worker, coarse()).get().why, HasSubstr("nothing that the map has a label for"));
}

TEST(HealthMapWorker, ChecksARequestAgainstItsLimits) {
  HealthMapWorker worker({}, oneWall(), view);
  EXPECT_EQ(worker.check(coarse()), "");
  HealthMapRequest fine = coarse();
  fine.cell_m = 0.001;  // 3001 x 2001 places
  EXPECT_THAT(worker.check(fine), HasSubstr("more than 120000 places"));
}

TEST(HealthMapWorker, RefusesAFifthWaitingRequestAndAnswersAllOnStop) {
  std::mutex gate;
  std::unique_lock closed(gate);
  HealthMapWorker worker({}, oneWall(), [&gate] {
    const std::lock_guard wait(gate);
    return view();
  });
  std::vector<std::future<Answer>> answers;
  for (int i = 0; i < 4; ++i) answers.push_back(draw(worker, coarse()));
  EXPECT_THAT(draw(worker, coarse()).get().why, HasSubstr("4 health maps are waiting already"));
  closed.unlock();
  for (auto& answer : answers) EXPECT_TRUE(answer.get().map);
  worker.stop();
  EXPECT_THAT(draw(worker, coarse()).get().why, HasSubstr("localization stops"));
}

}  // namespace
}  // namespace vismem
