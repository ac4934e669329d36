// The registry of drivers: names, unknown names, each driver's own keys.
#include "common/drivers/driver_registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/config_error.h"

namespace vismem {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct Lamp {
  std::string kind;
  long brightness = 0;
};

DriverRegistry<Lamp> lamps() {
  DriverRegistry<Lamp> registry;
  registry.add("led", "a light-emitting diode", [](ConfigReader& group) {
    return std::make_unique<Lamp>(Lamp{"led", group.integer("Brightness", 5, 0, 10)});
  });
  registry.add("candle", "wax", [](ConfigReader&) { return std::make_unique<Lamp>(Lamp{"candle", 1}); });
  return registry;
}

struct Made {
  std::unique_ptr<Lamp> lamp;
  std::vector<std::string> problems;
};

Made make(const std::string& text) {
  const auto properties = Properties::parse(text, "a.cfg");
  ConfigReader config(properties);
  ConfigReader group = config.group("House.Lamp");
  Made made;
  made.lamp = lamps().make(group);
  try {
    config.finish();
  } catch (const ConfigError& error) {
    made.problems = error.problems();
  }
  return made;
}

TEST(DriverRegistry, MakesTheNamedDriverWithItsOwnKeys) {
  const Made made = make("House.Lamp.Driver=led\nHouse.Lamp.Brightness=7\n");
  EXPECT_THAT(made.problems, IsEmpty());
  ASSERT_TRUE(made.lamp);
  EXPECT_EQ(made.lamp->kind, "led");
  EXPECT_EQ(made.lamp->brightness, 7);
  EXPECT_THAT(lamps().names(), ElementsAre("candle", "led"));
  EXPECT_EQ(lamps().summary("candle"), "wax");
}

TEST(DriverRegistry, NamesTheKnownDriversForAnUnknownOne) {
  const Made made = make("House.Lamp.Driver=lad\nHouse.Lamp.Brightness=7\n");
  EXPECT_FALSE(made.lamp);
  EXPECT_THAT(made.problems, ElementsAre("a.cfg:1: House.Lamp.Driver = lad (unknown driver (did you mean "
                                         "\"led\"?); must be one of: candle, led)"));
}

TEST(DriverRegistry, NamesTheKnownDriversWhenNoneIsNamed) {
  const Made made = make("House.Lamp.Brightness=7\n");
  EXPECT_FALSE(made.lamp);
  EXPECT_THAT(made.problems,
              ElementsAre("a.cfg: missing key \"House.Lamp.Driver\" (must be a driver: candle, led)"));
}

TEST(DriverRegistry, ListsTheDriversAndTheKeysOfTheNamedOne) {
  const auto keysOf = [](const std::string& text) {
    const auto properties = Properties::parse(text, "a.cfg");
    ConfigReader config(properties);
    ConfigReader group = config.group("House.Lamp");
    lamps().make(group);
    std::vector<std::string> lines;
    for (const KeyDescription& key : config.keys()) lines.push_back(key.key + ": " + key.range);
    return lines;
  };
  EXPECT_THAT(keysOf(""), ElementsAre("House.Lamp.Driver: a driver: candle, led"));
  EXPECT_THAT(keysOf("House.Lamp.Driver=led\n"),
              ElementsAre("House.Lamp.Driver: a driver: candle, led", "House.Lamp.Brightness: 0..10"));
}

TEST(DriverRegistry, LeavesADriversProblemsInTheReader) {
  EXPECT_THAT(make("House.Lamp.Driver=led\nHouse.Lamp.Brightness=11\nHouse.Lamp.Colour=red\n").problems,
              ElementsAre("a.cfg:2: House.Lamp.Brightness = 11 (must be 0..10)",
                          "a.cfg:3: unknown key \"House.Lamp.Colour\""));
  EXPECT_THAT(make("House.Lamp.Driver=candle\nHouse.Lamp.Brightness=1\n").problems,
              ElementsAre("a.cfg:2: unknown key \"House.Lamp.Brightness\""));
}

}  // namespace
}  // namespace vismem
