// Runs a fuzz target over the files of a folder, without a fuzzer: see vismem_fuzzer.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int argc, char** argv) {
  std::vector<std::filesystem::path> seeds;
  std::error_code failure;
  if (argc == 2) {
    for (const auto& entry : std::filesystem::directory_iterator(argv[1], failure)) seeds.push_back(entry.path());
  }
  if (seeds.empty()) {
    std::fprintf(stderr, "usage: %s FOLDER   (with at least one seed)\n", argv[0]);
    return 2;
  }
  std::sort(seeds.begin(), seeds.end());
  for (const auto& seed : seeds) {
    std::printf("%s\n", seed.c_str());
    std::fflush(stdout);  // so that a crash shows which one
    std::ifstream file(seed, std::ios::binary);
    const std::string content{std::istreambuf_iterator<char>(file), {}};
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
  }
  return 0;
}
