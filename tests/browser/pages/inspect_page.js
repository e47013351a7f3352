// What is wrong with how a page looks, measured: text that is hard to read, things that stick out, unnamed controls.
() => {
  const faults = [];
  const root = document.documentElement;
  if (root.scrollWidth > innerWidth) faults.push(`the page is ${root.scrollWidth} px wide in a window of ${innerWidth}`);

  const shown = (node) => node.checkVisibility({ visibilityProperty: true, opacityProperty: true });
  const clipped = (node) => getComputedStyle(node).clipPath !== "none" || node.closest(".screen-reader");
  const visible = [...document.body.querySelectorAll("*")].filter((node) => shown(node) && !clipped(node));

  for (const node of visible) {
    const box = node.getBoundingClientRect();
    const inPicture = node.closest(".picture, svg");
    if (!inPicture && (box.left < -1 || box.right > innerWidth + 1)) faults.push(`${name(node)} sticks out`);
    if (node.matches("button, a, input") && Math.min(box.width, box.height) < 24) faults.push(`${name(node)} is too small to hit`);
    if (node.matches("button, a, input, [role=slider], [role=button], summary") && !accessibleName(node)) {
      faults.push(`${name(node)} has no name`);
    }
    const ownText = [...node.childNodes].some((child) => child.nodeType === Node.TEXT_NODE && child.data.trim());
    if (ownText && !node.matches(":disabled") && !inPicture) {
      const ratio = contrast(node);
      const style = getComputedStyle(node);
      const large = parseFloat(style.fontSize) >= 24 || (parseFloat(style.fontSize) >= 18.66 && style.fontWeight >= 600);
      if (ratio < (large ? 3 : 4.5)) faults.push(`${name(node)}: contrast ${ratio.toFixed(2)}`);
    }
  }
  return faults;

  function name(node) {
    return `<${node.tagName.toLowerCase()} id="${node.id}" class="${node.className}"> ${node.textContent.trim().slice(0, 30)}`;
  }

  function accessibleName(node) {
    return node.getAttribute("aria-label") || node.textContent.trim() || node.labels?.[0]?.textContent.trim();
  }

  // WCAG 2.2: relative luminance and contrast ratio.
  function contrast(node) {
    const [ink, ground] = [luminance(color(getComputedStyle(node).color)), luminance(background(node))];
    return (Math.max(ink, ground) + 0.05) / (Math.min(ink, ground) + 0.05);
  }

  function background(node) {
    for (let at = node; at; at = at.parentElement) {
      const [r, g, b, alpha = 1] = color(getComputedStyle(at).backgroundColor);
      if (alpha > 0.9) return [r, g, b];
    }
    return [255, 255, 255];
  }

  function color(text) {
    const numbers = text.match(/[\d.]+/g).map(Number);
    return text.startsWith("color(") ? [...numbers.slice(0, 3).map((value) => 255 * value), ...numbers.slice(3)] : numbers;
  }

  function luminance(rgb) {
    const [r, g, b] = rgb.map((value) => value / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  }
}
