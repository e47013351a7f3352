// A video that is drawn when somebody asks for it, however long that takes.

const ASK_AGAIN_MS = 1500;
const NOT_READY = 202;

/**
 * The video's bytes. Fails with a sentence for people.
 * @param {string} url
 */
export async function drawnVideo(url) {
  for (;;) {
    const response = await fetch(url);
    if (response.status !== NOT_READY) return bytesOf(response);
    await new Promise((resolve) => {
      setTimeout(resolve, ASK_AGAIN_MS);
    });
  }
}

/** @param {Response} response */
async function bytesOf(response) {
  if (response.ok) return response.blob();
  const answer = await response.json().catch(() => ({}));
  throw new Error(answer.error?.message ?? "The video cannot be had; reload the page to try again.");
}
