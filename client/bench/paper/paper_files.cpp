#include "client/bench/paper/paper_files.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "client/bench/paper/paper_json.h"
#include "client/bench/paper/paper_page.h"
#include "client/lib/file_bytes.h"

namespace curvecast::cli::bench {
namespace {

std::string page_in(const std::string& folder) { return (std::filesystem::path(folder) / "paper.html").string(); }
std::string numbers_in(const std::string& folder) { return (std::filesystem::path(folder) / "paper.json").string(); }

}  // namespace

absl::Status prepare_paper_folder(const std::string& folder) {
  std::error_code error;  // what is wrong shows when files are to be written
  std::filesystem::create_directories(folder, error);
  for (const std::string& path : {page_in(folder), numbers_in(folder)}) {
    if (absl::Status status = client::check_writable(path); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status write_paper_files(const std::string& folder, const PaperFindings& findings) {
  // Names of files need not be UTF-8.
  const std::string numbers = paper_json(findings).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  if (absl::Status status = client::write_bytes(numbers_in(folder), numbers); !status.ok()) return status;
  return client::write_bytes(page_in(folder), paper_page(findings));
}

std::string paper_summary(const std::string& folder, const PaperFindings& findings) {
  const std::vector<Claim> claims = claims_of(findings);
  std::string text = absl::StrFormat("%d of %d claims hold; all tables and figures: %s\n",
                                     std::ranges::count_if(claims, &Claim::holds), claims.size(), page_in(folder));
  for (const Claim& claim : claims) {
    if (claim.holds) continue;
    absl::StrAppendFormat(&text, "does not hold: %s: ours %.4g, the paper's %.4g\n", claim.text, claim.ours, claim.paper);
  }
  return text;
}

}  // namespace curvecast::cli::bench
