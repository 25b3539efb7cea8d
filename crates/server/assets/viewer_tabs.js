// Tabs: the panels beside the map, one of which is open.

/** The panels are below the map, as the style has it. */
export const BELOW = matchMedia("(max-width: 60rem)");

/** Opens panels by the tabs of a list; `opened(panel)` hears the id of the one that was opened. */
export function tabList(tabs, opened) {
  const panelOf = (tab) => document.getElementById(tab.getAttribute("aria-controls"));
  const open = (panel) => {
    for (const tab of tabs) {
      const chosen = tab.getAttribute("aria-controls") === panel;
      tab.setAttribute("aria-selected", String(chosen));
      tab.tabIndex = chosen ? 0 : -1;
      panelOf(tab).hidden = !chosen;
    }
    document.getElementById(panel).scrollTop = 0;
    opened(panel);
  };
  tabs.forEach((tab, index) => {
    tab.addEventListener("click", () => {
      open(panelOf(tab).id);
      if (BELOW.matches) tab.parentElement.parentElement.scrollIntoView();
    });
    tab.addEventListener("keydown", ({ key }) => {
      const by = { ArrowRight: 1, ArrowLeft: -1 }[key];
      const to = { Home: 0, End: tabs.length - 1 }[key] ?? (by && (index + by + tabs.length) % tabs.length);
      if (to === undefined) return;
      open(panelOf(tabs[to]).id);
      tabs[to].focus();
    });
  });
  return open;
}
