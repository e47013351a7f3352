// Types of three.mjs, for tsc alone; services/web/vendor/three.js says what of three.js is in it.
export * from "three";
