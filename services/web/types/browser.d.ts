// What browsers have and TypeScript's own declarations leave out.

/** iPhones alone ask before a page may know how they are turned. */
interface DeviceOrientationPermission {
  requestPermission?(): Promise<"granted" | "denied">;
}

/** WebHID (wicg.github.io/webhid), as far as a SpaceMouse needs it; Chromium's browsers have it. */
interface HidFilter {
  vendorId: number;
  usagePage?: number;
  usage?: number;
}

interface HidDevice {
  readonly vendorId: number;
  readonly opened: boolean;
  open(): Promise<void>;
  addEventListener(type: "inputreport", listener: (report: { reportId: number; data: DataView }) => void): void;
}

interface HidNavigator {
  readonly hid?: {
    getDevices(): Promise<HidDevice[]>;
    requestDevice(options: { filters: HidFilter[] }): Promise<HidDevice[]>;
  };
}

/** A headset's controller that can be felt (w3.org/TR/webxr-gamepads-module-1). */
type PulsedGamepad = Gamepad & {
  readonly hapticActuators?: readonly { pulse(strength: number, ms: number): Promise<unknown> }[];
};
