#include "broken_config/cases.h"

namespace vismem::test {
namespace {

constexpr int kManyLines = 5000;

std::string manyLines() {
  std::string lines;
  for (int i = 0; i < kManyLines; ++i) lines += "junk\n";
  return lines;
}

/// The first 20 problems, and how many more there are; two keys are missing.
std::vector<std::string> manyMessages() {
  std::vector<std::string> messages = {
      "broken.cfg: missing key \"Localization.VisualMemory.Proxy\" (must be the proxy of a visual memory, "
      "such as "
      "VisualMemory:tcp -h 127.0.0.1 -p 9970)",
      "broken.cfg: missing key \"Localization.Map\" (must be a map of labelled segments, such as "
      "cfg/maps/corridor.csv)"};
  for (int line = 1; line <= 18; ++line) {
    messages.push_back("broken.cfg:" + std::to_string(line) + ": \"junk\" (must be KEY = VALUE)");
  }
  messages.push_back("and " + std::to_string(kManyLines - 18) + " more problems");
  return messages;
}

}  // namespace

std::vector<BrokenConfig> filesAndLines() {
  const std::string l = "localization";
  return {
      {"NoFileOfThisName",
       l,
       {},
       {"absent.cfg: cannot be read (No such file or directory; must be a configuration of lines KEY = "
        "VALUE)"},
       2,
       {},
       {},
       {"--Ice.Config=absent.cfg"}},
      {"FileIsAFolder",
       l,
       {},
       {".: cannot be read (is a folder; must be a configuration of lines KEY = VALUE)"},
       2,
       {},
       {},
       {"--Ice.Config=."}},
      {"FileCannotBeRead",
       l,
       {},
       {"/proc/self/mem: cannot be read (Input/output error; must be a configuration of lines KEY = VALUE)"},
       2,
       {},
       {},
       {"--Ice.Config=/proc/self/mem"}},
      {"FileNeverEnds",
       l,
       {},
       {"/dev/zero: cannot be read (more than 64 MB; must be a configuration of lines KEY = VALUE)"},
       2,
       {},
       {},
       {"--Ice.Config=/dev/zero"}},
      {"EmptyFile",
       l,
       {},
       {"broken.cfg: missing key \"Localization.VisualMemory.Proxy\" (must be the proxy of a visual memory, "
        "such as VisualMemory:tcp -h 127.0.0.1 -p 9970)",
        "broken.cfg: missing key \"Localization.Map\" (must be a map of labelled segments, such as "
        "cfg/maps/corridor.csv)"},
       2,
       {},
       {},
       {},
       "\n"},
      {"TwoFiles",
       l,
       {},
       {"command line: two configuration files, broken.cfg and other.cfg (must be one)"},
       2,
       {},
       {},
       {"broken.cfg", "other.cfg"}},
      {"ArgumentWithoutValue",
       l,
       {},
       {"command line: \"--Localization.Seed\" (must be --Key=Value)"},
       2,
       {},
       {},
       {"broken.cfg", "--Localization.Seed"}},
      {"ArgumentWithOneDash",
       l,
       {},
       {"command line: \"-Localization.Seed=3\" (must be --Key=Value)"},
       2,
       {},
       {},
       {"broken.cfg", "-Localization.Seed=3"}},
      {"ArgumentOutOfRange",
       l,
       {},
       {"command line: Localization.Seed = -3 (must be 0..2000000000)"},
       2,
       {},
       {},
       {"broken.cfg", "--Localization.Seed=-3"}},
      {"UnknownKey",
       l,
       {"Localization.Rases.Maximum = 5"},
       {"broken.cfg:1: unknown key \"Localization.Rases.Maximum\" (did you mean "
        "\"Localization.Races.Maximum\"?)"}},
      {"UnknownKeyLikeNoOther",
       l,
       {"Localization.Zebra = 5"},
       {"broken.cfg:1: unknown key \"Localization.Zebra\""}},
      {"UnknownPrefix",
       l,
       {"Localisation.Seed = 5"},
       {"broken.cfg:1: unknown key \"Localisation.Seed\" (did you mean \"Localization.Seed\"?)"}},
      {"KeyOfAnotherComponent",
       l,
       {"Simulator.Speed = 5"},
       {"broken.cfg:1: unknown key \"Simulator.Speed\" (must begin with Localization. or Robot.)"}},
      {"UnknownKeyOfIce",
       l,
       {"Ice.MesageSizeMax = 5"},
       {"broken.cfg:1: unknown key \"Ice.MesageSizeMax\" (did you mean \"Ice.MessageSizeMax\"?)"}},
      {"IceValueOfWrongType",
       l,
       {"Ice.MessageSizeMax = plenty"},
       {"broken.cfg:1: Ice.MessageSizeMax = plenty (must be a whole number, 1..1048576)"}},
      {"IceValueOutOfRange",
       l,
       {"Ice.ThreadPool.Server.Size = -1"},
       {"broken.cfg:1: Ice.ThreadPool.Server.Size = -1 (must be a whole number, 1..1000)"}},
      {"IceConfigInsideAFile",
       l,
       {"Ice.Config = other.cfg"},
       {"broken.cfg:1: Ice.Config = other.cfg (has no effect inside a configuration; must be on the command "
        "line)"}},
      {"DuplicateKey",
       l,
       {"Localization.Seed = 1", "", "Localization.Seed = 2"},
       {"broken.cfg:3: key \"Localization.Seed\" is set twice (first in line 1)"}},
      {"JunkLine",
       l,
       {"# fine", "Localization.Seed 1"},
       {"broken.cfg:2: \"Localization.Seed 1\" (must be KEY = VALUE)"}},
      {"IncludeOfNothing",
       l,
       {"include other.cfg"},
       {"broken.cfg:1: \"include other.cfg\" (must be KEY = VALUE)"}},
      {"NoKey", l, {"= 3"}, {"broken.cfg:1: \"= 3\" has no key (must be KEY = VALUE)"}},
      {"SectionHeader", l, {"[Localization]"}, {"broken.cfg:1: \"[Localization]\" (must be KEY = VALUE)"}},
      {"WindowsLinesAndByteOrderMark",
       l,
       {},
       {"broken.cfg: missing key \"Localization.VisualMemory.Proxy\" (must be the proxy of a visual memory, "
        "such as VisualMemory:tcp -h 127.0.0.1 -p 9970)",
        "broken.cfg:2: Localization.Seed = x (must be a whole number, 0..2000000000)"},
       2,
       {},
       {},
       {},
       "\xEF\xBB\xBFLocalization.Map = map.csv\r\nLocalization.Seed = x\r\n"},
      {"NotUtf8",
       l,
       {"Localization.S\xE9"
        "ed = \xFF\xFE",
        "Localization.Mode = d\xE9"
        "faut"},
       {"broken.cfg:1: unknown key \"Localization.S\\xe9ed\" (did you mean \"Localization.Seed\"?)",
        "broken.cfg:2: Localization.Mode = d\\xe9faut (must be one of: default, chapter)"}},
      {"ControlCharacters",
       l,
       {"Localization.Mode = a\x1b[2Jb", std::string("Localization.Seed = 1\0"
                                                     "2",
                                                     23)},
       {"broken.cfg:1: Localization.Mode = a\\x1b[2Jb (must be one of: default, chapter)",
        "broken.cfg:2: Localization.Seed = 1\\x002 (must be a whole number, 0..2000000000)"}},
      {"BinaryFile",
       l,
       {},
       {"broken.cfg: is a binary file (must be a configuration of lines KEY = VALUE)"},
       2,
       {},
       {},
       {},
       std::string("\x7f"
                   "ELF\2\1\1\0\0\0\0\0\0\0\0\0\3\0>\0\1\0\0\0",
                   24)},
      {"AVeryLongValue",
       l,
       {"Localization.Mode = " + std::string(1'000'000, 'x')},
       {"broken.cfg:1: Localization.Mode = " + std::string(632, 'x') + "[... 999069 bytes ...]" +
        std::string(299, 'x') + " (must be one of: default, chapter)"}},
      {"AVeryLongKey",
       l,
       {"Localization." + std::string(100'000, 'k') + " = 1"},
       {"broken.cfg:1: unknown key \"Localization." + std::string(626, 'k') + "[... 99041 bytes ...]" +
        std::string(333, 'k') + "\""}},
      {"AVeryLongLine",
       l,
       {std::string(1'000'000, 'j')},
       {"broken.cfg:1: \"" + std::string(651, 'j') + "[... 999038 bytes ...]" + std::string(311, 'j') +
        "\" (must be KEY = VALUE)"}},
      {"ThousandsOfProblems", l, {}, manyMessages(), 2, {}, {}, {}, manyLines()},
      {"SeveralErrorsAtOnce",
       l,
       {"Localization.Seed = many", "junk", "Localization.Races.Maximum = 0",
        "Localization.Health.Source = eyes", "Localization.Palette = none.palette", "Localization.Zebra = 1",
        "Localization.LogLevel = loud"},
       {"broken.cfg: missing key \"Localization.VisualMemory.Proxy\" (must be the proxy of a visual memory, "
        "such as VisualMemory:tcp -h 127.0.0.1 -p 9970)",
        "broken.cfg:1: Localization.Seed = many (must be a whole number, 0..2000000000)",
        "broken.cfg:2: \"junk\" (must be KEY = VALUE)",
        "broken.cfg:3: Localization.Races.Maximum = 0 (must be 1..64)",
        "broken.cfg:4: Localization.Health.Source = eyes (must be one of: memory, image, both)",
        "broken.cfg:5: Localization.Palette = none.palette (no such file or folder in HERE or the folders "
        "above)",
        "broken.cfg:6: unknown key \"Localization.Zebra\"",
        "broken.cfg:7: Localization.LogLevel = loud (must be one of: debug, info, warning, error)"},
       2,
       {"Localization.VisualMemory.Proxy"}},
  };
}

std::vector<BrokenConfig> proxiesAndEndpoints() {
  const std::string l = "localization";
  const std::string m = "active_visual_memory";
  return {
      {"ProxyMalformed",
       l,
       {"Localization.VisualMemory.Proxy = VisualMemory:tcp -h"},
       {"broken.cfg:1: Localization.VisualMemory.Proxy = VisualMemory:tcp -h (must be a proxy such as "
        "cameraA:tcp -h 127.0.0.1 -p 9999: no argument provided for -h option in endpoint `tcp  -h')"}},
      {"ProxyEmpty",
       l,
       {"Localization.VisualMemory.Proxy ="},
       {"broken.cfg:1: Localization.VisualMemory.Proxy = (empty) (must be the proxy of a visual memory, such "
        "as VisualMemory:tcp -h 127.0.0.1 -p 9970)"}},
      {"ProxyOfUnknownTransport",
       l,
       {"Localization.VisualMemory.Proxy = VisualMemory:carrier -p 9970"},
       {"broken.cfg:1: Localization.VisualMemory.Proxy = VisualMemory:carrier -p 9970 (must be a proxy such "
        "as cameraA:tcp -h 127.0.0.1 -p 9999: invalid endpoint `carrier -p 9970' in `VisualMemory:carrier -p "
        "9970')"}},
      {"ProxyWithoutEndpoint",
       l,
       {"Localization.VisualMemory.Proxy = VisualMemory"},
       {"broken.cfg:1: Localization.VisualMemory.Proxy = VisualMemory (must be a proxy such as cameraA:tcp "
        "-h 127.0.0.1 -p 9999: it has no endpoint, and no Ice.Default.Locator would find one)"}},
      {"ProxyWithoutPort",
       l,
       {"Localization.VisualMemory.Proxy = VisualMemory:tcp -h 127.0.0.1"},
       {"broken.cfg:1: Localization.VisualMemory.Proxy = VisualMemory:tcp -h 127.0.0.1 (must be a proxy such "
        "as cameraA:tcp -h 127.0.0.1 -p 9999: it has no port (-p))"}},
      {"ProxyPortTooLarge",
       l,
       {"Localization.VisualMemory.Proxy = VisualMemory:tcp -p 99999"},
       {"broken.cfg:1: Localization.VisualMemory.Proxy = VisualMemory:tcp -p 99999 (must be a proxy such as "
        "cameraA:tcp -h 127.0.0.1 -p 9999: port value `99999' out of range in endpoint `tcp  -p 99999')"}},
      {"ProxyOptionUnknown",
       l,
       {"Localization.VisualMemory.Proxy = VisualMemory:tcp -q 9970"},
       {"broken.cfg:1: Localization.VisualMemory.Proxy = VisualMemory:tcp -q 9970 (must be a proxy such as "
        "cameraA:tcp -h 127.0.0.1 -p 9999: unrecognized argument `-q' in endpoint `tcp -q 9970')"}},
      {"ProxiesMalformed",
       m,
       {"ActiveVisualMemory.Camera.Proxy = :tcp -p 9999",
        "ActiveVisualMemory.PanTilt.Proxy = PanTilt tcp -p 9977"},
       {"broken.cfg:1: ActiveVisualMemory.Camera.Proxy = :tcp -p 9999 (must be a proxy such as cameraA:tcp "
        "-h 127.0.0.1 -p 9999: no identity in `:tcp -p 9999')",
        "broken.cfg:2: ActiveVisualMemory.PanTilt.Proxy = PanTilt tcp -p 9977 (must be a proxy such as "
        "cameraA:tcp -h 127.0.0.1 -p 9999: expected a proxy option but found `tcp' in `PanTilt tcp -p "
        "9977')"}},
      {"EndpointsEmpty",
       l,
       {"Localization.Endpoints ="},
       {"broken.cfg:1: Localization.Endpoints = (empty) (must be endpoints such as tcp -h 127.0.0.1 -p "
        "9999)"}},
      {"EndpointsMalformed",
       l,
       {"Localization.Endpoints = 9971"},
       {"broken.cfg:1: Localization.Endpoints = 9971 (must be endpoints such as tcp -h 127.0.0.1 -p 9999: "
        "invalid endpoint `9971')"}},
      {"EndpointsWithAnIdentity",
       l,
       {"Localization.Endpoints = VisualMemory:tcp -p 9971"},
       {"broken.cfg:1: Localization.Endpoints = VisualMemory:tcp -p 9971 (must be endpoints such as tcp -h "
        "127.0.0.1 -p 9999: one is of an unknown transport)"}},
      {"EndpointsOptionUnknown",
       l,
       {"Localization.Endpoints = tcp --port 9971"},
       {"broken.cfg:1: Localization.Endpoints = tcp --port 9971 (must be endpoints such as tcp -h 127.0.0.1 "
        "-p 9999: unrecognized argument `--port' in endpoint `tcp --port 9971')"}},
      {"PortInUse",
       l,
       {"Localization.Endpoints = tcp -h 127.0.0.1 -p PORT"},
       {"cannot serve at Localization.Endpoints = tcp -h 127.0.0.1 -p PORT (adapter LocalizationAdapter): "
        "Address already in use"},
       1},
      {"PortInUseOfSimulator",
       "simulator",
       {"Simulator.Endpoints = tcp -h 127.0.0.1 -p PORT"},
       {"cannot serve at Simulator.Endpoints = tcp -h 127.0.0.1 -p PORT (adapter SimulatorAdapter): Address "
        "already in use"},
       1},
      {"PortInUseOfMemory",
       m,
       {"ActiveVisualMemory.WebEndpoints = ws -h 127.0.0.1 -p PORT", "Robot.Token = 0123456789abcdef"},
       {"cannot serve at ActiveVisualMemory.WebEndpoints = ws -h 127.0.0.1 -p PORT (adapter "
        "ActiveVisualMemoryWebAdapter): Address already in use"},
       1},
      {"WebSocketAmongPlainEndpoints",
       l,
       {"Localization.Endpoints = tcp -h 127.0.0.1 -p 9971:ws -h 127.0.0.1 -p 11005"},
       {"broken.cfg:1: Localization.Endpoints = tcp -h 127.0.0.1 -p 9971:ws -h 127.0.0.1 -p 11005 (must be "
        "endpoints "
        "such as tcp -h 127.0.0.1 -p 9999: ws and wss belong into the key WebEndpoints, where clients need a "
        "token)"}},
      {"WebSocketByDefaultProtocol",
       l,
       {"Localization.Endpoints = default -h 127.0.0.1 -p 9971", "Ice.Default.Protocol = ws"},
       {"broken.cfg:1: Localization.Endpoints = default -h 127.0.0.1 -p 9971 (must be endpoints such as tcp "
        "-h "
        "127.0.0.1 -p 9999: ws and wss belong into the key WebEndpoints, where clients need a token)"}},
      {"PlainEndpointForWebPages",
       l,
       {"Localization.WebEndpoints = tcp -h 127.0.0.1 -p 11005"},
       {"broken.cfg:1: Localization.WebEndpoints = tcp -h 127.0.0.1 -p 11005 (must be endpoints such as ws "
        "-h "
        "127.0.0.1 -p 11000: only ws and wss belong here)"}},
      {"TokenThatIsShort",
       l,
       {"Robot.Token = 0123456789"},
       {"broken.cfg:1: Robot.Token = *** (must be 16..100 letters, digits, '-' or '_')"}},
      {"RobotNameWithADot",
       l,
       {"Robot.Name = robot.7"},
       {"broken.cfg:1: Robot.Name = robot.7 (must be 1..40 letters, digits, '-' or '_')"}},
      {"PlainEndpointForOtherMachines",
       l,
       {"Localization.Endpoints = tcp -h 127.0.0.1 -p 9971:tcp -h 0.0.0.0 -p 9972"},
       {"broken.cfg:1: Localization.Endpoints = tcp -h 127.0.0.1 -p 9971:tcp -h 0.0.0.0 -p 9972 (must be ssl "
        "-h "
        "0.0.0.0 ... with the keys IceSSL.* of docs/deployment.md, since other machines reach it, or -h "
        "127.0.0.1 "
        "behind a gateway; Localization.PlainRemote = yes lets everybody in)"}},
      {"PlainEndpointByDefaultHost",
       l,
       {"Localization.Endpoints = tcp -p 9971", "Ice.Default.Host = 192.0.2.1"},
       {"broken.cfg:1: Localization.Endpoints = tcp -p 9971 (must be ssl -h 192.0.2.1 ... with the keys "
        "IceSSL.* of "
        "docs/deployment.md, since other machines reach it, or -h 127.0.0.1 behind a gateway; "
        "Localization.PlainRemote = yes lets everybody in)"}},
      {"PlainWebEndpointForOtherMachines",
       l,
       {"Localization.WebEndpoints = ws -h 192.0.2.1 -p 11005"},
       {"broken.cfg:1: Localization.WebEndpoints = ws -h 192.0.2.1 -p 11005 (must be wss -h 192.0.2.1 ... "
        "with the "
        "keys IceSSL.* of docs/deployment.md, since other machines reach it, or -h 127.0.0.1 behind a "
        "gateway; "
        "Localization.PlainRemote = yes lets everybody in)"}},
      {"EndpointWithTlsForCallersWithoutACertificate",
       l,
       {"Localization.Endpoints = ssl -h 192.0.2.1 -p 9971", "Ice.Plugin.IceSSL = IceSSL:createIceSSL",
        "IceSSL.VerifyPeer = 1"},
       {"broken.cfg:3: IceSSL.VerifyPeer = 1 (must be 2, since other machines reach Localization.Endpoints: "
        "each "
        "caller needs a certificate then)"}},
      {"PageForOtherMachines",
       "gui_server",
       {"GuiServer.Http.Endpoints = http -h 0.0.0.0 -p 8770", "Robot.Token = 0123456789abcdef"},
       {"broken.cfg:1: GuiServer.Http.Endpoints = http -h 0.0.0.0 -p 8770 (must be http -h 127.0.0.1 -p "
        "PORT, since "
        "pages are served without TLS and may hold a token; GuiServer.PlainRemote = yes serves them to "
        "everybody)"}},
      {"PageWithATokenThatIsTooShort",
       "gui_server",
       {"GuiServer.Http.Endpoints = 8770", "Robot.Token = abc"},
       {"broken.cfg:1: GuiServer.Http.Endpoints = 8770 (must be http -h HOST -p PORT, such as http -h "
        "127.0.0.1 "
        "-p 8770)",
        "broken.cfg:2: Robot.Token = *** (must be 16..100 letters, digits, '-' or '_')"}},
      {"AddressOfAnotherHost",
       l,
       {"Localization.Endpoints = tcp -h 192.0.2.1 -p 9971", "Localization.PlainRemote = yes"},
       {"cannot serve at Localization.Endpoints = tcp -h 192.0.2.1 -p 9971 (adapter LocalizationAdapter): "
        "Cannot assign requested address"},
       1},
      {"HostThatIsUnknown",
       l,
       {"Localization.Endpoints = tcp -h nowhere.invalid -p 9971", "Localization.PlainRemote = yes"},
       {"cannot serve at Localization.Endpoints = tcp -h nowhere.invalid -p 9971 (adapter "
        "LocalizationAdapter): unknown host nowhere.invalid"},
       1},
      {"LogFileCannotBeWritten",
       l,
       {"Ice.LogFile = absent/localization.log"},
       {"broken.cfg: Ice cannot begin with its keys (initialization exception: FileLogger: cannot open "
        "absent/localization.log)"}},
      {"AdapterKeyUnknown",
       l,
       {"LocalizationAdapter.ThreadPool.Sise = 3"},
       {"broken.cfg:1: unknown key \"LocalizationAdapter.ThreadPool.Sise\" (did you mean "
        "\"LocalizationAdapter.ThreadPool.Size\"?)"}},
  };
}

}  // namespace vismem::test
