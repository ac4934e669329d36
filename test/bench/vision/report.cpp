#include "bench/vision/report.h"

#include <cstdarg>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace vismem {
namespace {

using nlohmann::json;

__attribute__((format(printf, 1, 2))) std::string format(const char* pattern, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

double ratio(double theirs, double ours) {
  return ours > 0.0 ? theirs / ours : 0.0;
}

std::string speedText(const SpeedTable& table) {
  const double ours = table.msOf(kOurs);
  std::string out = format("\nSpeed at %s: %d images, %d runs each, one thread, gray input\n",
                           table.size.c_str(), table.images, table.runs);
  out += format("%-14s %9s %9s %9s %12s\n", "detector", "ms", "worst", "segments", "x ours");
  for (const SpeedRow& row : table.rows) {
    out += format("%-14s %9.3f %9.3f %9.0f %12.2f\n", row.detector.c_str(), row.ms, row.worst_ms,
                  row.segments, ratio(row.ms, ours));
  }
  out += format("%s is %.1f times faster than %s and %.1f times faster than %s\n", kOurs.c_str(),
                ratio(table.msOf(kTunedEdLines), ours), kTunedEdLines.c_str(), ratio(table.msOf(kLsd), ours),
                kLsd.c_str());
  return out;
}

std::string photographText(const PhotographTable& table) {
  std::string out = format("\nAccuracy at %s: %d images\n", table.size.c_str(), table.images);
  out += format("%-14s %5s %5s %5s %5s %5s %5s %5s %5s %5s %6s | %5s %5s | %5s %5s %5s\n", "detector", "P1",
                "F1", "P2", "R2", "F2", "F5", "sF5", "frag", "redun", "nseg", "F2evn", "F2odd", "repS5",
                "repO1", "loc");
  for (const PhotographRow& row : table.rows) {
    const AccuracySummary& all = row.all;
    out += format(
        "%-14s %5.3f %5.3f %5.3f %5.3f %5.3f %5.3f %5.3f %5.2f %5.2f %6.0f | %5.3f %5.3f | %5.3f %5.3f "
        "%5.3f\n",
        row.detector.c_str(), all.at[0].precision, all.at[0].f(), all.at[1].precision, all.at[1].recall,
        all.at[1].f(), all.at[2].f(), all.structural.f(), all.fragments, all.redundancy, all.segments,
        row.even.at[1].f(), row.odd.at[1].f(), row.repeatability.structuralShare(),
        row.repeatability.orthogonalShare(), row.repeatability.localisation_px());
  }
  for (const Difference& d : table.differences) {
    out += format(
        "%-3s %.3f against %.3f of the best peer, %s: %.3f times, difference %+.3f (95 %%: %+.3f .. %+.3f)\n",
        d.measure.c_str(), d.ours, d.theirs, d.peer.c_str(), ratio(d.ours, d.theirs), d.ours - d.theirs,
        d.low, d.high);
  }
  return out;
}

std::string exactText(const std::vector<ExactRow>& rows) {
  std::string out =
      "\nExact edges (320x240): F at 1 px and RMS of ends about the true line [px]; segments per image of "
      "noise\n";
  out += format("%-14s %7s %7s %7s %7s   %s\n", "detector", "F n3", "rms n3", "F n10", "rms n10",
                "sigma 5 / 15 / 40");
  for (const ExactRow& row : rows) {
    out += format("%-14s %7.3f %7.3f %7.3f %7.3f   %.1f / %.1f / %.1f\n", row.detector.c_str(),
                  row.f1_at_noise_3, row.rms_px_at_noise_3, row.f1_at_noise_10, row.rms_px_at_noise_10,
                  row.false_segments[0], row.false_segments[1], row.false_segments[2]);
  }
  return out;
}

json summaryJson(const AccuracySummary& sum) {
  return {{"P1", sum.at[0].precision},    {"R1", sum.at[0].recall},    {"F1", sum.at[0].f()},
          {"P2", sum.at[1].precision},    {"R2", sum.at[1].recall},    {"F2", sum.at[1].f()},
          {"F5", sum.at[2].f()},          {"sF5", sum.structural.f()}, {"fragments", sum.fragments},
          {"redundancy", sum.redundancy}, {"segments", sum.segments}};
}

/// Rounded to what the measurement is worth; keeps the line readable.
void roundNumbers(json& value) {
  if (value.is_number_float()) {
    value = std::stod(format("%.4g", value.get<double>()));
  } else if (value.is_structured()) {
    for (auto& part : value) roundNumbers(part);
  }
}

class CsvFile {
 public:
  CsvFile(const std::filesystem::path& file, const std::string& head) : name_(file.string()), out_(file) {
    out_ << head << '\n';
  }
  void row(const std::string& text) { out_ << text << '\n'; }
  void close() {
    out_.close();
    if (!out_) throw std::runtime_error(name_ + ": cannot be written");
  }

 private:
  std::string name_;
  std::ofstream out_;
};

void writeSpeed(const VisionResults& results, const std::filesystem::path& file) {
  CsvFile csv(file, "size,detector,ms,worst_ms,segments,times_ours");
  for (const SpeedTable& table : results.speed) {
    for (const SpeedRow& row : table.rows) {
      csv.row(format("%s,%s,%.5f,%.5f,%.1f,%.3f", table.size.c_str(), row.detector.c_str(), row.ms,
                     row.worst_ms, row.segments, ratio(row.ms, table.msOf(kOurs))));
    }
  }
  csv.close();
}

void writeAccuracy(const VisionResults& results, const std::filesystem::path& folder) {
  CsvFile csv(
      folder / "accuracy.csv",
      "size,detector,P1,R1,F1,P2,R2,F2,P5,R5,F5,sF5,fragments,redundancy,segments,F2_even,F2_odd,repS5,repO1,"
      "localisation_px");
  CsvFile images(folder / "accuracy_images.csv",
                 "size,detector,image,P1,R1,P2,R2,P5,R5,sP5,sR5,lines,fragments,segments");
  for (const PhotographTable& table : results.photographs) {
    for (const PhotographRow& row : table.rows) {
      const AccuracySummary& a = row.all;
      csv.row(format(
          "%s,%s,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.1f,%.4f,%.4f,%.4f,%.4f,%.4f",
          table.size.c_str(), row.detector.c_str(), a.at[0].precision, a.at[0].recall, a.at[0].f(),
          a.at[1].precision, a.at[1].recall, a.at[1].f(), a.at[2].precision, a.at[2].recall, a.at[2].f(),
          a.structural.f(), a.fragments, a.redundancy, a.segments, row.even.at[1].f(), row.odd.at[1].f(),
          row.repeatability.structuralShare(), row.repeatability.orthogonalShare(),
          row.repeatability.localisation_px()));
      for (std::size_t i = 0; i < row.images.size(); ++i) {
        const ImageScore& s = row.images[i];
        images.row(format("%s,%s,%s,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%ld,%ld,%ld", table.size.c_str(),
                          row.detector.c_str(), table.names[i].c_str(), s.at[0].precision, s.at[0].recall,
                          s.at[1].precision, s.at[1].recall, s.at[2].precision, s.at[2].recall,
                          s.structural.precision, s.structural.recall, s.lines, s.fragments, s.segments));
      }
    }
  }
  csv.close();
  images.close();
}

void writeExact(const VisionResults& results, const std::filesystem::path& file) {
  CsvFile csv(
      file,
      "detector,F1_noise3,rms_px_noise3,F1_noise10,rms_px_noise10,false_sigma5,false_sigma15,false_sigma40");
  for (const ExactRow& row : results.exact) {
    csv.row(format("%s,%.4f,%.4f,%.4f,%.4f,%.3f,%.3f,%.3f", row.detector.c_str(), row.f1_at_noise_3,
                   row.rms_px_at_noise_3, row.f1_at_noise_10, row.rms_px_at_noise_10, row.false_segments[0],
                   row.false_segments[1], row.false_segments[2]));
  }
  csv.close();
}

}  // namespace

std::string textReport(const VisionResults& results) {
  std::string out = results.machine + "\nimages: " + results.images + "\n";
  for (const DetectorEntry& entry : measuredDetectors()) {
    out += format("  %-14s %s\n", entry.name.c_str(), entry.settings.c_str());
  }
  for (const SpeedTable& table : results.speed) out += speedText(table);
  for (const PhotographTable& table : results.photographs) out += photographText(table);
  if (!results.exact.empty()) out += exactText(results.exact);
  return out;
}

nlohmann::json jsonReport(const VisionResults& results) {
  json out{{"machine", results.machine}};
  for (const SpeedTable& table : results.speed) {
    json& size = out["speed"][table.size];
    for (const SpeedRow& row : table.rows) size["ms"][row.detector] = row.ms;
    size["times_faster_than_tuned_edlines"] = ratio(table.msOf(kTunedEdLines), table.msOf(kOurs));
    size["times_faster_than_lsd"] = ratio(table.msOf(kLsd), table.msOf(kOurs));
  }
  for (const PhotographTable& table : results.photographs) {
    json& size = out["accuracy"][table.size];
    size["images"] = table.images;
    for (const PhotographRow& row : table.rows) {
      json& one = size["detectors"][row.detector];
      one = summaryJson(row.all);
      one["F2_even"] = row.even.at[1].f();
      one["F2_odd"] = row.odd.at[1].f();
      one["repS5"] = row.repeatability.structuralShare();
      one["repO1"] = row.repeatability.orthogonalShare();
      one["localisation_px"] = row.repeatability.localisation_px();
    }
    for (const Difference& d : table.differences) {
      size["best_peer"][d.measure] = {{"peer", d.peer},
                                      {"times", ratio(d.ours, d.theirs)},
                                      {"difference", d.ours - d.theirs},
                                      {"low", d.low},
                                      {"high", d.high}};
    }
  }
  for (const ExactRow& row : results.exact) {
    out["exact"][row.detector] = {{"F1_noise3", row.f1_at_noise_3},
                                  {"rms_px_noise3", row.rms_px_at_noise_3},
                                  {"F1_noise10", row.f1_at_noise_10},
                                  {"rms_px_noise10", row.rms_px_at_noise_10},
                                  {"noise_only_segments", row.false_segments}};
  }
  roundNumbers(out);
  return out;
}

void writeCsv(const VisionResults& results, const std::filesystem::path& folder) {
  if (!results.speed.empty()) writeSpeed(results, folder / "speed.csv");
  if (!results.photographs.empty()) writeAccuracy(results, folder);
  if (!results.exact.empty()) writeExact(results, folder / "exact.csv");
}

}  // namespace vismem
