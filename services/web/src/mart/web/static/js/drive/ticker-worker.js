const PERIOD_MS = 16;

setInterval(() => postMessage(0), PERIOD_MS);
