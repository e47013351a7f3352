// A picture that a phone's camera reads.

/**
 * Shows the code in an image.
 * @param {HTMLImageElement} image
 * @param {string} svg as the server sends it
 */
export function showQrCode(image, svg) {
  image.src = `data:image/svg+xml,${encodeURIComponent(withNamespace(svg))}`;
}

/** @param {string} svg */
const withNamespace = (svg) =>
  svg.includes("xmlns=") ? svg : svg.replace("<svg", '<svg xmlns="http://www.w3.org/2000/svg"');
