// Meshes, textures and paths of third-party models.
#include "simulator/core/renderer.h"
#include "simulator/core/world_material.h"
#include "simulator/third_party_worlds.h"

namespace vismem {
namespace {

using testing::Contains;
using testing::HasSubstr;

std::string binaryStl(const std::string& header) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  const std::uint32_t count = 1;
  bytes.append(reinterpret_cast<const char*>(&count), 4);
  const float numbers[12] = {0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0};
  bytes.append(reinterpret_cast<const char*>(numbers), sizeof numbers);
  bytes.append(2, '\0');
  return bytes;
}

/// A triangle over (0,0,0) (2,0,0) (0,3,0) in nodes below each other.
std::string collada(const std::string& asset, const std::string& nodes) {
  return "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' "
         "version='1.4.1'><asset>" +
         asset +
         "</asset><library_geometries><geometry id='g' name='tri'><mesh><source id='p'><float_array id='pa' "
         "count='9'>0 0 0 "
         "2 0 0 0 3 0</float_array><technique_common><accessor source='#pa' count='3' stride='3'><param "
         "name='X' "
         "type='float'/><param name='Y' type='float'/><param name='Z' "
         "type='float'/></accessor></technique_common></source>"
         "<vertices id='v'><input semantic='POSITION' source='#p'/></vertices><triangles count='1'><input "
         "semantic='VERTEX' source='#v' offset='0'/><p>0 1 "
         "2</p></triangles></mesh></geometry></library_geometries>"
         "<library_visual_scenes><visual_scene id='s'>" +
         nodes +
         "</visual_scene></library_visual_scenes><scene><instance_visual_scene url='#s'/></scene></COLLADA>";
}

TEST_F(ThirdPartyWorlds, MeshesInEveryFormatTheyCome) {
  put("binary.stl", binaryStl("made by a program"));
  put("solid.STL", binaryStl("solid but binary"));
  put("text.stl",
      "solid part\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 3 "
      "0\nendloop\nendfacet\n"
      "endsolid part\n");
  put("negative.obj",
      "# no normals, no mtl, indices from the end, a polygon of five\nmtllib lost.mtl\nusemtl paint\n"
      "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 3 0\nv 0 3 0\nf -5 -4 -3 -2 -1\n");
  const std::string instance = "<instance_geometry url='#g'/>";
  put("y_up.dae", collada("<unit meter='1'/><up_axis>Y_UP</up_axis>", "<node>" + instance + "</node>"));
  put("centimetres.DAE", collada("<unit meter='0.01' name='centimeter'/><up_axis>Z_UP</up_axis>",
                                 "<node><scale>100 100 100</scale>" + instance + "</node>"));
  put("nested.dae", collada("<up_axis>Z_UP</up_axis>",
                            "<node><translate>0 0 1</translate><node><scale>0.5 1 1</scale>" + instance +
                                "<node><translate>2 0 0</translate>" + instance + "</node></node></node>"));
  const auto shapeOf = [&](const std::string& file, const std::string& scale = "1 1 1") {
    const auto loaded =
        load(sdf("<model name='m'><link name='l'><visual name='v'><geometry><mesh><uri>" + file +
                 "</uri><scale>" + scale + "</scale></mesh></geometry></visual></link></model>"));
    return bounds(loaded.world, "m");
  };
  const Eigen::Vector3f zero(0, 0, 0);
  for (const char* file :
       {"binary.stl", "solid.STL", "text.stl", "negative.obj", "y_up.dae", "centimetres.DAE"}) {
    SCOPED_TRACE(file);
    expectBounds(shapeOf(file), zero, {2, 3, 0});
    expectBounds(shapeOf(file, "-1 2 1"), {-2, 0, 0}, {0, 6, 0});
  }
  expectBounds(shapeOf("nested.dae"), {0, 0, 1}, {2, 3, 1});
}

TEST_F(ThirdPartyWorlds, PicturesThatAreNoneCostTheirTexture) {
  put("zero.png", "");
  put("cut.png", std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\0\0\0\0\0\x08\x02\0\0\0", 29));
  std::string content;
  for (const char* name : {"zero", "cut"}) {
    put(std::string(name) + ".obj", "mtllib " + std::string(name) +
                                        ".mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                                        "usemtl m\nf 1/1 2/2 3/3\n");
    put(std::string(name) + ".mtl", "newmtl m\nKd 0.2 0.4 0.6\nmap_Kd " + std::string(name) + ".png\n");
    content += "<model name='" + std::string(name) +
               "'><link name='l'><visual name='v'><geometry><mesh><uri>" + name +
               ".obj</uri></mesh></geometry></visual></link></model>";
  }
  const auto loaded = load(sdf(content));
  ASSERT_EQ(loaded.world.bodyCount(), 2) << testing::PrintToString(loaded.warnings);
  for (const auto& model : loaded.world.models) {
    EXPECT_FALSE(model.bodies[0].texture);
    EXPECT_TRUE(model.bodies[0].color.isApprox(Eigen::Vector3f(0.2F, 0.4F, 0.6F)));
  }
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("zero.png: is empty")));
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("cut.png: not a picture in a known format")));
}

TEST_F(ThirdPartyWorlds, SubMeshesHaveTheNamesOfTheNodes) {
  const std::string instance = "<instance_geometry url='#g'/>";
  put("named.dae", collada("<up_axis>Z_UP</up_axis>",
                           "<node id='node_1' name='Lid'><translate>0 0 1</translate>" + instance +
                               "</node><node id='node_2' name='Pot'>" + instance + "</node>"));
  const auto loaded =
      load(sdf("<model name='m'><link name='l'><visual name='v'><geometry><mesh><uri>named.dae</uri><submesh>"
               "<name>Lid</name></submesh></mesh></geometry></visual></link></model>"));
  expectBounds(bounds(loaded.world, "m"), {0, 0, 1}, {2, 3, 1});
}

/// A TGA picture of 2 x 2 pixels: red, green above; blue, white below.
std::string tga(int kind, int bits, bool from_top, const std::string& pixels,
                const std::string& colour_map = "") {
  std::string bytes(18, '\0');
  bytes[1] = colour_map.empty() ? '\0' : '\1';
  bytes[2] = static_cast<char>(kind);
  bytes[5] = static_cast<char>(colour_map.size() / 3);
  bytes[7] = colour_map.empty() ? '\0' : '\x18';
  bytes[12] = bytes[14] = 2;
  bytes[16] = static_cast<char>(bits);
  bytes[17] = static_cast<char>(from_top ? 0x20 : 0);
  return bytes + colour_map + pixels;
}

TEST(Textures, ComeAsTga) {
  const std::string red("\0\0\xFF", 3);
  const std::string green("\0\xFF\0", 3);
  const std::string blue("\xFF\0\0", 3);
  const std::string white("\xFF\xFF\xFF", 3);
  const std::vector<std::uint8_t> wanted{255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
  const auto rgb = [](const std::string& bytes) { return decodeTexture(bytes, "a.tga")->rgb; };
  EXPECT_EQ(rgb(tga(2, 24, true, red + green + blue + white)), wanted);
  EXPECT_EQ(rgb(tga(2, 24, false, blue + white + red + green)), wanted);
  const std::string opaque = "\xFF";
  EXPECT_EQ(rgb(tga(2, 32, true, red + opaque + green + opaque + blue + opaque + white + opaque)), wanted);
  EXPECT_EQ(
      rgb(tga(10, 24, true, "\x01" + red + green + std::string("\x80") + blue + std::string("\x80") + white)),
      wanted);
  EXPECT_EQ(rgb(tga(1, 8, true, std::string("\x00\x01\x02\x03", 4), red + green + blue + white)), wanted);
  EXPECT_EQ(rgb(tga(2, 16, true, std::string("\x00\x7C\xE0\x03\x1F\x00\xFF\x7F", 8))), wanted);
  EXPECT_EQ(rgb(tga(11, 8, true, std::string("\x83\x40", 2))), std::vector<std::uint8_t>(12, 0x40));
  for (const std::string& cut :
       {tga(2, 24, true, red + green + blue), tga(10, 24, true, "\x03" + red),
        tga(1, 8, true, std::string("\x04\x04\x04\x04", 4), red), std::string(17, '\0')}) {
    EXPECT_THAT(
        [&] { decodeTexture(cut, "cut.tga"); },
        testing::ThrowsMessage<std::runtime_error>(HasSubstr("cut.tga: not a picture in a known format")));
  }
}

TEST_F(ThirdPartyWorlds, MirroredMeshesKeepTheirOutside) {
  // A tetrahedron with outward faces, mirrored in one and in three axes.
  put("tetra.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  for (const Eigen::Vector3d& scale :
       {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(-1, 1, 1), Eigen::Vector3d(-1, -1, -1)}) {
    std::ostringstream text;
    text << scale.transpose();
    const auto loaded = load(
        sdf("<model name='m'><link name='l'><visual name='v'><geometry><mesh><uri>tetra.obj</uri><scale>" +
            text.str() + "</scale></mesh></geometry></visual></link></model>"));
    const Renderer renderer(loaded.world);
    const Eigen::Vector3d inside = 0.2 * scale;
    for (const Eigen::Vector3d& from :
         {Eigen::Vector3d(3, 0, 0), Eigen::Vector3d(-3, 0, 0), Eigen::Vector3d(0, 0, 3)}) {
      const auto hit = renderer.cast(inside + from, -from);
      ASSERT_TRUE(hit);
      EXPECT_FALSE(hit->from_inside) << text.str() << " from " << from.transpose();
    }
  }
}

TEST_F(ThirdPartyWorlds, FilesAreFoundWhereverWorldsSayTheyAre) {
  const std::string wedge = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  put("thing/meshes/part.obj", wedge);
  put("some_package/models/thing/meshes/part.obj", wedge);
  put("with space/part.obj", wedge);
  for (const std::string& uri :
       {std::string("model://thing/meshes/part.obj"), std::string("file://thing/meshes/part.obj"),
        std::string("thing/meshes/part.obj"), std::string("./thing/meshes/../meshes/part.obj"),
        "file://" + (folder_ / "thing/meshes/part.obj").string(),
        (folder_ / "thing/meshes/part.obj").string(),
        std::string("package://some_package/models/thing/meshes/part.obj"),
        std::string("https://fuel.gazebosim.org/1.0/Somebody/models/thing/2/files/meshes/part.obj"),
        std::string("model://with space/part.obj")}) {
    const auto loaded =
        load(sdf("<include><uri>model://ground_plane</uri></include><model name='m'><link name='l'><visual "
                 "name='v'><geometry><mesh><uri>" +
                 uri + "</uri></mesh></geometry></visual></link></model>"));
    EXPECT_TRUE(loaded.world.modelNamed("m")) << uri << testing::PrintToString(loaded.warnings);
  }
}

}  // namespace
}  // namespace vismem
