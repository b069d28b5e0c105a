// The corpus, a line for each file: as Markdown, as comma-separated values, as JSON.
#pragma once

#include <string>
#include <vector>

#include "client/bench/corpus.h"

namespace curvecast::cli::bench {

std::string corpus_markdown(const std::vector<CorpusEntry>& entries);  // the table, then the summary
std::string corpus_csv(const std::vector<CorpusEntry>& entries);       // with a line of headings; RFC 4180
Json corpus_json(const std::vector<CorpusEntry>& entries);             // bench_json of the summary, with `files`

}  // namespace curvecast::cli::bench
