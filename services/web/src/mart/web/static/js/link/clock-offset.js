// How far the gateway's clock is ahead of this page's, from pings. The fastest ping knows best. Pure.

const KEPT = 10;

/** Knows the gateway's clock from the newest pongs. */
export class ClockOffset {
  /** @type {{ roundTripUs: number, offsetNs: number }[]} */
  #samples = [];

  /**
   * Takes a pong in; returns the gateway's clock minus this page's, nanoseconds.
   * @param {Omit<StatusChannel.Pong, "type">} pong
   * @param {number} nowUs
   */
  pong({ t_us: sentUs, gateway_ns: gatewayNs }, nowUs) {
    const roundTripUs = nowUs - sentUs;
    const sample = { roundTripUs, offsetNs: gatewayNs - (sentUs + roundTripUs / 2) * 1000 };
    this.#samples = [...this.#samples, sample].slice(-KEPT);
    return this.#samples.reduce((best, one) => (one.roundTripUs < best.roundTripUs ? one : best)).offsetNs;
  }
}
