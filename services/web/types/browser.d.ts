// What browsers have and TypeScript's own declarations leave out.

/** iPhones alone ask before a page may know how they are turned. */
interface DeviceOrientationPermission {
  requestPermission?(): Promise<"granted" | "denied">;
}
