// How others come in: address, join code, and both as a picture.

import { invitation, messageOf } from "./api.js";
import { byId, element, setText } from "./dom.js";
import { showQrCode } from "./qr-code.js";

const COPY = "Copy the link";

/** Fills the card `invite` whenever it is opened. */
export function offerInvitation() {
  const card = byId("invite", HTMLDetailsElement);
  const picture = element("img", { alt: "Code to scan with a phone's camera", width: 200, height: 200 });
  const address = element("code");
  const others = element("dd", { class: "soft" });
  const code = element("code");
  const watching = element("code");
  const hint = element("p", { class: "message calm" });
  const copy = element("button", { type: "button" }, COPY);
  const facts = element(
    "dl",
    {},
    element("dt", {}, "Address"),
    element("dd", {}, address),
    others,
    element("dt", {}, "Join code"),
    element("dd", {}, code),
    element("dt", {}, "To watch only, without a seat"),
    element("dd", {}, watching),
  );
  const words = element(
    "p",
    { class: "soft" },
    "Scan it, or type the address. The browser may warn once that this site vouches for itself: go on. ",
  );
  const told = element("div", { class: "facts" }, hint, facts, words, copy);
  card.append(element("div", { class: "inviting" }, picture, told));
  let link = "";

  async function show() {
    if (!card.open) return;
    setText(copy, COPY);
    try {
      const answer = await invitation();
      const { url, other_urls: otherUrls, code: joinCode, qr_svg: svg, watch_url: watchUrl, hint: why } = answer;
      showQrCode(picture, svg);
      link = `${url}#code=${joinCode}`;
      setText(address, url);
      setText(code, joinCode);
      setText(others, otherUrls.length ? `or ${otherUrls.join(", ")}` : "");
      setText(watching, watchUrl);
      setText(hint, why);
      picture.classList.toggle("small", why !== ""); // no other device gets there
    } catch (error) {
      setText(hint, messageOf(error));
    }
  }

  card.addEventListener("toggle", show);
  copy.addEventListener("click", async () => {
    const copied = await navigator.clipboard.writeText(link).then(() => true, () => false);
    setText(copy, copied ? "Copied" : "It could not be copied; select the address instead");
  });
}
