// Worlds of 150 visuals: loaded and mapped within ten seconds of CPU each, with progress.
#include <cmath>
#include <cstdio>
#include <ctime>
#include <sstream>

#include "common/vision/palette.h"
#include "simulator/core/map_builder.h"
#include "simulator/third_party_worlds.h"

namespace vismem {
namespace {

constexpr double kMost_s = 10.0;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr double kSlower = 5.0;
#else
constexpr double kSlower = 1.0;
#endif

class CpuTime {
 public:
  double seconds() const { return static_cast<double>(std::clock() - begin_) / CLOCKS_PER_SEC; }

 private:
  std::clock_t begin_ = std::clock();
};

/// A ball of 2 * rows * columns triangles as a mesh file.
std::string ballObj(int rows, int columns) {
  std::ostringstream text;
  for (int i = 0; i <= rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double v = M_PI * i / rows;
      const double u = 2.0 * M_PI * j / columns;
      text << "v " << 0.25 * std::sin(v) * std::cos(u) << " " << 0.25 * std::sin(v) * std::sin(u) << " "
           << 0.25 * std::cos(v) << "\n";
    }
  }
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int a = 1 + i * columns + j;
      const int b = 1 + i * columns + (j + 1) % columns;
      text << "f " << a << " " << a + columns << " " << b + columns << "\nf " << a << " " << b + columns
           << " " << b << "\n";
    }
  }
  return text.str();
}

class ManyVisuals : public ThirdPartyWorlds {
 protected:
  static constexpr int kVisuals = 149;  // and the floor

  /// 30 included models, each five times: crates, cans and finely meshed balls.
  std::string world(const std::string& friction) {
    put("ball/ball.obj", ballObj(40, 50));
    for (int i = 0; i < 30; ++i) {
      const std::string shape = i % 3 == 0   ? "<box><size>0.3 0.2 0.5</size></box>"
                                : i % 3 == 1 ? "<cylinder><radius>0.1</radius><length>0.4</length></cylinder>"
                                             : "<mesh><uri>model://ball/ball.obj</uri></mesh>";
      const std::string look = i % 2 == 0 ? "0.8 0.8 0.8 1" : "0.6 0.4 0.2 1";
      putModel("thing" + std::to_string(i),
               "<sdf version='1.6'><model name='thing'><static>1</static><link name='l'><collision name='c'>"
               "<geometry><box><size>0.3 0.2 0.5</size></box></geometry><surface><friction><ode><mu>" +
                   friction + "</mu></ode></friction></surface></collision><visual name='v'><geometry>" +
                   shape + "</geometry><material><diffuse>" + look +
                   "</diffuse></material></visual></link></model></sdf>");
    }
    std::string content =
        "<model name='floor'><static>1</static><link name='l'><visual name='v'><geometry><plane><normal>0 0 1"
        "</normal><size>12 8</size></plane></geometry><material><diffuse>0.2 0.2 0.22 1</diffuse></material>"
        "</visual></link></model>";
    for (int i = 0; i < kVisuals; ++i) {
      content += "<include><name>n" + std::to_string(i) + "</name><uri>model://thing" +
                 std::to_string(i % 30) + "</uri><pose>" + std::to_string((i % 15) * 0.7 - 5) + " " +
                 std::to_string((i / 15) * 0.7 - 3.5) + " 0.25 0 0 " + std::to_string(0.1 * i) +
                 "</pose></include>\n";
    }
    return sdf(content);
  }
};

TEST_F(ManyVisuals, AreLoadedAndMappedInTime) {
  const Palette palette = Palette::parse(
      "class.floor = value 0..30\nclass.wood = hue 15..50 saturation 40..100\nclass.grey = saturation 0..20 "
      "value "
      "40..100\npair.box = floor grey\npair.crate = floor wood\n",
      "p.palette");
  for (const char* friction : {"0.9", "high"}) {
    put("w.world", world(friction));
    std::size_t models = 0;
    const CpuTime loading;
    const LoadedWorld loaded = loadWorld(folder_ / "w.world", {}, [&](std::size_t done, std::size_t all) {
      EXPECT_EQ(done, ++models);
      EXPECT_EQ(all, std::size_t{kVisuals + 1});
    });
    const double load_s = loading.seconds();
    EXPECT_EQ(loaded.summary(), "150 of 150 visuals");
    EXPECT_THAT(loaded.warnings, testing::IsEmpty());
    EXPECT_EQ(models, std::size_t{kVisuals + 1});
    std::size_t edges = 0;
    const CpuTime mapping;
    const SegmentMap map =
        buildSegmentMap(loaded.world, palette, {}, [&](std::size_t done, std::size_t) { edges = done; });
    std::printf("friction %s: loaded in %.1f s, mapped in %.1f s of CPU: %zu edges, %zu segments\n", friction,
                load_s, mapping.seconds(), edges, map.segments.size());
    EXPECT_LT(load_s, kSlower * kMost_s);
    EXPECT_LT(mapping.seconds(), kSlower * kMost_s);
    EXPECT_GT(edges, 1000U);
    EXPECT_GT(map.segments.size(), 100U);
  }
}

}  // namespace
}  // namespace vismem
