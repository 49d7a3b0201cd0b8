// For scripts/site: what scrolls is reached by keys, the search has a name, and an empty head of a column is no head.
const reached = (part) => { if (part.tabIndex) { part.tabIndex = 0; } };
document$.subscribe(() => setTimeout(() => {
  document.querySelectorAll(".md-typeset__scrollwrap, .md-search__scrollwrap, pre > code").forEach((part) => {
    reached(part);
    new MutationObserver(() => reached(part)).observe(part, { attributeFilter: ["tabindex"] }); // the theme takes it away on phones
  });
  document.querySelector("[data-md-component=search]").setAttribute("aria-label", "Search");
  document.querySelectorAll("th:empty").forEach((head) => { head.outerHTML = "<td></td>"; });
}));
