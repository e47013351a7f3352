// How far the gateway's clock is ahead of this page's, from pings. The fastest ping knows best. Pure.

const KEPT = 10;

export class ClockOffset {
  #samples = []; // { roundTripUs, offsetNs }

  /** Takes a pong in; returns the offset in nanoseconds. */
  pong({ t_us: sentUs, gateway_ns: gatewayNs }, nowUs) {
    const roundTripUs = nowUs - sentUs;
    const offsetNs = gatewayNs - (sentUs + roundTripUs / 2) * 1000;
    this.#samples = [...this.#samples, { roundTripUs, offsetNs }].slice(-KEPT);
    return this.#samples.reduce((best, one) => (one.roundTripUs < best.roundTripUs ? one : best)).offsetNs;
  }
}
