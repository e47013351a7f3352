"""What is wrong with how a page looks and with what a screen reader finds in it."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import Page

INSPECT = (Path(__file__).parent / "inspect_page.js").read_text()
AXE = Path("node_modules/axe-core/axe.min.js").read_text()
# Contrast is looked at by INSPECT, which knows what a picture is and takes a tenth of the time.
SERIOUS = """async () => {
  const rules = { "color-contrast": { enabled: false } };
  const told = await axe.run(document, { resultTypes: ["violations"], rules });
  return told.violations
    .filter(({ impact }) => impact === "serious" || impact === "critical")
    .map(({ id, help, nodes }) => `${id}: ${help}: ${nodes.map(({ html }) => html.slice(0, 120)).join(" ")}`);
}"""


IS_DARK = "() => matchMedia('(prefers-color-scheme: dark)').matches"


def faults(page: Page) -> list[str]:
    """Return a sentence for each fault; axe-core's serious and critical findings among them.

    What axe-core looks at is the same in the dark, so it looks by light alone.
    """
    found: list[str] = page.evaluate(INSPECT)
    if page.evaluate(IS_DARK):
        return found
    if not page.evaluate("() => 'axe' in window"):
        page.evaluate(AXE)
    return [*found, *page.evaluate(SERIOUS)]
