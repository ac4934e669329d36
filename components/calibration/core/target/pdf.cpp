#include "calibration/core/target/pdf.h"

#include <cstddef>
#include <cstdio>

namespace vismem {
namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;
/// Height of a capital letter of Helvetica in its size.
constexpr double kCapitalHeight = 0.718;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.5f", value);
  return text;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '(' || c == ')' || c == '\\') out += '\\';
    out += c;
  }
  return "(" + out + ")";
}

/// One path of all rectangles, filled once: separate fills would show seams between neighbours.
std::string contentOf(const PrintedPage& page) {
  std::string out = number(kPointsPerMm) + " 0 0 " + number(kPointsPerMm) + " 0 0 cm\n0 g\n";
  for (const PrintedRectangle& r : page.black) {
    out += number(r.x) + " " + number(r.y) + " " + number(r.width) + " " + number(r.height) + " re\n";
  }
  out += "f\n";
  for (const PrintedText& t : page.texts) {
    out += "BT /F1 " + number(t.size / kCapitalHeight) + " Tf " + (t.upwards ? "0 1 -1 0 " : "1 0 0 1 ") +
           number(t.x) + " " + number(t.y) + " Tm " + escaped(t.text) + " Tj ET\n";
  }
  return out;
}

/// Numbers objects in the order they are added and writes their table.
class PdfFile {
 public:
  void add(const std::string& object) {
    offsets_.push_back(bytes_.size());
    bytes_ += std::to_string(offsets_.size()) + " 0 obj\n" + object + "\nendobj\n";
  }
  /// Ends the file. @param info number of the object with the title; the catalogue is object 1.
  std::string finish(std::size_t info) {
    const std::size_t table = bytes_.size();
    const std::string size = std::to_string(offsets_.size() + 1);
    bytes_ += "xref\n0 " + size + "\n0000000000 65535 f \n";
    for (const std::size_t offset : offsets_) {
      char line[32];
      std::snprintf(line, sizeof line, "%010zu 00000 n \n", offset);
      bytes_ += line;
    }
    bytes_ += "trailer\n<< /Size " + size + " /Root 1 0 R /Info " + std::to_string(info) +
              " 0 R >>\nstartxref\n" + std::to_string(table) + "\n%%EOF\n";
    return std::move(bytes_);
  }

 private:
  std::string bytes_ = "%PDF-1.4\n";
  std::vector<std::size_t> offsets_;
};

}  // namespace

std::string writePdf(const std::vector<PrintedPage>& pages, const std::string& title) {
  // Objects: catalogue, list of pages, font, title; then a page and its content for each.
  constexpr std::size_t kFirstPage = 5;
  PdfFile file;
  file.add("<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>");
  std::string kids;
  for (std::size_t i = 0; i < pages.size(); ++i) kids += std::to_string(kFirstPage + 2 * i) + " 0 R ";
  file.add("<< /Type /Pages /Kids [ " + kids + "] /Count " + std::to_string(pages.size()) + " >>");
  file.add("<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>");
  file.add("<< /Title " + escaped(title) + " >>");
  for (std::size_t i = 0; i < pages.size(); ++i) {
    file.add("<< /Type /Page /Parent 2 0 R /MediaBox [ 0 0 " + number(kPointsPerMm * pages[i].width_mm) +
             " " + number(kPointsPerMm * pages[i].height_mm) +
             " ] /Resources << /Font << /F1 3 0 R >> >> /Contents " + std::to_string(kFirstPage + 2 * i + 1) +
             " 0 R >>");
    const std::string content = contentOf(pages[i]);
    file.add("<< /Length " + std::to_string(content.size()) + " >>\nstream\n" + content + "endstream");
  }
  return file.finish(4);
}

}  // namespace vismem
