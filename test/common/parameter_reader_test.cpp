// Tests C2.
#include "common/config/parameter_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/config_error.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

enum class Colour { kRed, kBlue };

struct Wheel {
  double radius_m = 0.1;
  double angle_rad = degToRad(30.0);

  void visit(ParameterVisitor& v) {
    v.real(basic("Radius_m", "of the wheel"), radius_m, 0.01, 1.0);
    v.angle(expert("Angle_deg", "of its axle"), angle_rad, -90.0, 90.0);
  }
};

struct Car {
  Wheel wheel;
  int doors = 4;
  int seats = 5;
  bool is_open = false;
  Colour colour = Colour::kBlue;
  std::vector<std::string> names{"one", "two"};

  void visit(ParameterVisitor& v) {
    v.group("Wheel", wheel);
    v.integer(basic("Doors", "number of doors"), doors, 0, 6);
    v.integer(expert("Seats", "number of seats"), seats, 1, 9);
    v.require("Doors", doors <= seats, "must not be more than", "Seats");
    v.alias("Roofless", "Open");
    v.flag(expert("Open", "without a roof"), is_open);
    v.choice(expert("Colour", "of the paint"), colour, {{"red", Colour::kRed}, {"blue", Colour::kBlue}});
    v.words(expert("Names", "of the owners"), names);
  }
};

struct Read {
  explicit Read(const std::string& text)
      : properties(Properties::parse(text, "car.cfg")), config(properties) {
    ParameterReader reader(config.group("Car"));
    car.visit(reader);
  }
  Properties properties;
  ConfigReader config;
  Car car;
};

TEST(ParameterReader, SetsEveryKindOfParameter) {
  Read read(
      "Car.Wheel.Radius_m = 0.5\nCar.Wheel.Angle_deg = 45\nCar.Doors = 2\nCar.Open = yes\nCar.Colour = red\n"
      "Car.Names = a  b c\n");
  EXPECT_NO_THROW(read.config.finish());
  EXPECT_DOUBLE_EQ(read.car.wheel.radius_m, 0.5);
  EXPECT_DOUBLE_EQ(read.car.wheel.angle_rad, degToRad(45.0));
  EXPECT_EQ(read.car.doors, 2);
  EXPECT_TRUE(read.car.is_open);
  EXPECT_EQ(read.car.colour, Colour::kRed);
  EXPECT_THAT(read.car.names, ElementsAre("a", "b", "c"));
}

TEST(ParameterReader, AParameterWithoutAKeyKeepsItsDefault) {
  Read read("");
  EXPECT_NO_THROW(read.config.finish());
  EXPECT_DOUBLE_EQ(read.car.wheel.radius_m, 0.1);
  EXPECT_NEAR(read.car.wheel.angle_rad, degToRad(30.0), 1e-12);
  EXPECT_EQ(read.car.colour, Colour::kBlue);
  EXPECT_THAT(read.car.names, ElementsAre("one", "two"));
}

TEST(ParameterReader, RangesRulesAndOldNamesAreTheReaders) {
  Read read(
      "Car.Wheel.Radius_m = 2\nCar.Doors = 6\nCar.Colour = green\nCar.Roofless = yes\nCar.Wheels = 4\n");
  try {
    read.config.finish();
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.problems(), ElementsAre("car.cfg:1: Car.Wheel.Radius_m = 2 (must be 0.01..1)",
                                              "car.cfg:2: Car.Doors = 6 (must not be more than Car.Seats)",
                                              "car.cfg:3: Car.Colour = green (must be one of: red, blue)",
                                              HasSubstr("car.cfg:5: unknown key \"Car.Wheels\"")));
  }
  EXPECT_TRUE(read.car.is_open);
  EXPECT_EQ(read.config.renamedKeys().size(), 1u);
}

TEST(ParameterReader, DescribesItsKeys) {
  const std::vector<KeyDescription> keys = Read("Car.Doors = 2\n").config.keys();
  ASSERT_EQ(keys.size(), 7u);
  std::vector<std::string> lines;
  for (const KeyDescription& one : keys) {
    lines.push_back(one.key + "|" + one.fallback + "|" + one.range + "|" + one.meaning +
                    (one.is_basic ? "|basic" : ""));
  }
  EXPECT_THAT(
      lines,
      ElementsAre("Car.Wheel.Radius_m|0.1|0.01..1|of the wheel|basic",
                  "Car.Wheel.Angle_deg|30|-90..90|of its axle", "Car.Doors|4|0..6|number of doors|basic",
                  "Car.Seats|5|1..9|number of seats", "Car.Open|no|yes or no|without a roof",
                  "Car.Colour|blue|one of: red, blue|of the paint", "Car.Names|one two||of the owners"));
}

}  // namespace
}  // namespace vismem
