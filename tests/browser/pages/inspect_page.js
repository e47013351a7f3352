// What is wrong with how a page looks, measured: text that is hard to read, things that stick out, unnamed controls.
() => {
  /** @type {string[]} */
  const faults = [];
  const root = document.documentElement;
  const width = root.scrollWidth;
  if (width > innerWidth) faults.push(`the page is ${width} px wide in a window of ${innerWidth}`);
  [...document.body.querySelectorAll("*")].filter(isVisible).forEach(inspect);
  return faults;

  /** @param {Element} node */
  function isVisible(node) {
    if (!node.checkVisibility({ visibilityProperty: true, opacityProperty: true })) return false;
    return getComputedStyle(node).clipPath === "none" && !node.closest(".screen-reader");
  }

  /** @param {Element} node */
  function inspect(node) {
    inspectControl(node);
    if (!node.closest(".picture, svg")) inspectText(node);
  }

  /** @param {Element} node */
  function inspectControl(node) {
    const box = node.getBoundingClientRect();
    if (node.matches("button, a, input") && Math.min(box.width, box.height) < 24) {
      faults.push(`${name(node)} is too small to hit`);
    }
    if (node.matches("button, a, input, [role=slider], [role=button], summary") && !accessibleName(node)) {
      faults.push(`${name(node)} has no name`);
    }
  }

  /** @param {Element} node */
  function inspectText(node) {
    const box = node.getBoundingClientRect();
    if (box.left < -1 || box.right > innerWidth + 1) faults.push(`${name(node)} sticks out`);
    if (!hasOwnText(node) || node.matches(":disabled")) return;
    const ratio = contrast(node);
    const least = isLarge(getComputedStyle(node)) ? 3 : 4.5;
    if (ratio < least) faults.push(`${name(node)}: contrast ${ratio.toFixed(2)}`);
  }

  /** @param {Element} node */
  function name(node) {
    const text = node.textContent?.trim().slice(0, 30);
    return `<${node.tagName.toLowerCase()} id="${node.id}" class="${node.getAttribute("class") ?? ""}"> ${text}`;
  }

  /** @param {Element} node */
  function accessibleName(node) {
    const labels = node instanceof HTMLInputElement ? node.labels : null;
    return node.getAttribute("aria-label") || node.textContent?.trim() || labels?.[0]?.textContent?.trim();
  }

  /** @param {Element} node */
  function hasOwnText(node) {
    return [...node.childNodes].some((child) => child instanceof Text && child.data.trim());
  }

  /** @param {CSSStyleDeclaration} style */
  function isLarge({ fontSize, fontWeight }) {
    return parseFloat(fontSize) >= 24 || (parseFloat(fontSize) >= 18.66 && Number(fontWeight) >= 600);
  }

  /**
   * WCAG 2.2: relative luminance and contrast ratio.
   * @param {Element} node
   */
  function contrast(node) {
    const [ink, ground] = [luminance(color(getComputedStyle(node).color)), luminance(background(node))];
    return (Math.max(ink, ground) + 0.05) / (Math.min(ink, ground) + 0.05);
  }

  /** @param {Element} node */
  function background(node) {
    for (let at = /** @type {Element | null} */ (node); at; at = at.parentElement) {
      const [r = 0, g = 0, b = 0, alpha = 1] = color(getComputedStyle(at).backgroundColor);
      if (alpha > 0.9) return [r, g, b];
    }
    return [255, 255, 255];
  }

  /** @param {string} text */
  function color(text) {
    const numbers = (text.match(/[\d.]+/g) ?? []).map(Number);
    if (!text.startsWith("color(")) return numbers;
    return [...numbers.slice(0, 3).map((value) => 255 * value), ...numbers.slice(3)];
  }

  /** @param {number[]} rgb */
  function luminance(rgb) {
    const [r = 0, g = 0, b = 0] = rgb.map((value) => linear(value / 255));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  }

  /** @param {number} value */
  function linear(value) {
    return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
  }
}
