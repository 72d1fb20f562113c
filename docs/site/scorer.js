// The order of the search: guides before the other pages, and these before scenes, internals and the changelog.
var Scorer = {
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
  score: ([page, , , , score]) => {
    if (/^(start|howto)\/|^(index|readme|peers|cite|scenes)$/.test(page)) return score + 40;
    if (/^(gallery\/.|rooms\/|reference\/|changelog|contributing|test_data|benchmarks)/.test(page)) return score - 20;
    return score;
  },
};
