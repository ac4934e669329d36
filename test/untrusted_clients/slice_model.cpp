#include "untrusted_clients/slice_model.h"

#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

namespace vismem::test {
namespace {

const std::set<std::string> kBuiltIn = {"bool", "byte", "short", "int", "long", "float", "double", "string"};

/// An interface before its bases are known.
struct Declared {
  std::vector<std::string> bases;
  std::vector<SliceOperation> operations;
};

class Reader {
 public:
  Reader(SliceModel& model, std::map<std::string, Declared>& declared, const std::filesystem::path& file)
      : model_(model), declared_(declared), file_(file) {
    std::ifstream in(file);
    std::stringstream text;
    text << in.rdbuf();
    static const std::regex kIgnored(R"(//[^\n]*|/\*[\s\S]*?\*/|#[^\n]*|\[[^\]]*\])");
    const std::string plain = std::regex_replace(text.str(), kIgnored, " ");
    static const std::regex kToken(R"([A-Za-z_][A-Za-z0-9_:]*|[{}();,<>=]|[0-9.+-]+)");
    for (std::sregex_iterator it(plain.begin(), plain.end(), kToken), end; it != end; ++it) {
      tokens_.push_back(it->str());
    }
  }

  void read() {
    while (at_ < tokens_.size()) {
      expect("module");
      module_ = next();
      expect("{");
      while (!take("}")) readDefinition();
      take(";");
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(file_.string() + ": " + what + " near \"" +
                             (at_ < tokens_.size() ? tokens_[at_] : "the end") + "\"");
  }
  std::string next() {
    if (at_ == tokens_.size()) fail("unexpected end");
    return tokens_[at_++];
  }
  bool take(const std::string& token) {
    if (at_ == tokens_.size() || tokens_[at_] != token) return false;
    ++at_;
    return true;
  }
  void expect(const std::string& token) {
    if (!take(token)) fail("no \"" + token + "\"");
  }

  std::string idOf(const std::string& name) const { return "::" + module_ + "::" + name; }
  std::string typeName(const std::string& written) const {
    if (kBuiltIn.contains(written)) return written;
    if (written.find("::") == std::string::npos) return idOf(written);
    return written.starts_with("::") ? written : "::" + written;
  }

  void readDefinition() {
    const std::string kind = next();
    if (kind == "enum") return readEnum();
    if (kind == "sequence") return readSequence();
    if (kind == "struct" || kind == "class" || kind == "exception") return readMembers(kind);
    if (kind == "interface") return readInterface();
    fail("\"" + kind + "\" is not understood");
  }

  void readEnum() {
    SliceType type{SliceType::Kind::kEnum, idOf(next()), {}, 0};
    expect("{");
    while (!take("}")) {
      next();
      ++type.enumerators;
      take(",");
    }
    finish(type);
  }

  void readSequence() {
    SliceType type{SliceType::Kind::kSequence, "", {}, 0};
    expect("<");
    type.members.push_back(typeName(next()));
    expect(">");
    type.type_id = idOf(next());
    finish(type);
  }

  void readMembers(const std::string& kind) {
    SliceType type{kind == "class" ? SliceType::Kind::kClass : SliceType::Kind::kStruct, idOf(next()), {}, 0};
    if (take("extends")) {
      if (kind == "class") fail("classes with a base are not understood");
      next();
    }
    if (take(";")) return;  // a declaration ahead
    expect("{");
    while (!take("}")) {
      type.members.push_back(typeName(next()));
      next();
      while (!take(";")) next();  // a default
    }
    if (kind != "exception") finish(type);
    take(";");
  }

  void readInterface() {
    const std::string id = idOf(next());
    Declared declared;
    if (take("extends")) {
      do declared.bases.push_back(typeName(next()));
      while (take(","));
    }
    if (take(";")) return;
    expect("{");
    while (!take("}")) {
      SliceOperation operation;
      operation.idempotent = take("idempotent");
      next();  // the result's type
      operation.name = next();
      expect("(");
      while (!take(")")) {
        const bool is_result = take("out");
        const std::string type = typeName(next());
        if (!is_result) operation.parameters.push_back(type);
        next();
        take(",");
      }
      while (!take(";")) next();  // throws ...
      declared.operations.push_back(operation);
    }
    take(";");
    declared_[id] = declared;
  }

  void finish(SliceType type) {
    take(";");
    model_.types[type.type_id] = std::move(type);
  }

  SliceModel& model_;
  std::map<std::string, Declared>& declared_;
  std::filesystem::path file_;
  std::vector<std::string> tokens_;
  std::size_t at_ = 0;
  std::string module_;
};

void addOperations(const std::map<std::string, Declared>& declared, const std::string& id,
                   SliceInterface& all) {
  const auto found = declared.find(id);
  if (found == declared.end()) throw std::runtime_error("no interface " + id);
  for (const auto& base : found->second.bases) addOperations(declared, base, all);
  all.operations.insert(all.operations.end(), found->second.operations.begin(),
                        found->second.operations.end());
}

}  // namespace

SliceModel readSlice(const std::filesystem::path& folder) {
  SliceModel model;
  std::map<std::string, Declared> declared;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".ice") Reader(model, declared, entry.path()).read();
  }
  for (const auto& [id, interface] : declared) {
    model.interfaces[id].type_id = id;
    addOperations(declared, id, model.interfaces[id]);
    for (const auto& operation : model.interfaces[id].operations) {
      for (const auto& type : operation.parameters) {
        if (!kBuiltIn.contains(type) && !model.types.contains(type))
          throw std::runtime_error("no type " + type);
      }
    }
  }
  return model;
}

}  // namespace vismem::test
