#pragma once

#include <frontlux/parallel.hpp>

#include <cstddef>
#include <span>

namespace frontlux::detail {

/// Answers a batch query by query: `answers[i]` becomes `answer(queries[i])`.
template <class Query, class Answer, class AnswerOne>
void answer_each(std::span<const Query> queries, std::span<Answer> answers, const AnswerOne& answer) {
  constexpr std::size_t kChunk = 256;
  for_each_chunk(queries.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) answers[i] = static_cast<Answer>(answer(queries[i]));
  });
}

}  // namespace frontlux::detail
