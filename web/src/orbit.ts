// Turning and approaching the subject by mouse, touch and keys.

export interface OrbitTarget {
  /** Radians, and a factor of the distance. */
  turn(azimuth: number, elevation: number, scale: number): void;
  reset(): void;
  togglePlaying(): void;
}

const kRadiansPerPixel = 0.008;
const kRadiansPerKey = Math.PI / 24;
const kScalePerKey = 1.15;
const kScalePerPixel = 0.0015;

export function followInput(element: HTMLElement, target: OrbitTarget, signal: AbortSignal): void {
  const pointers = new Map<number, { x: number; y: number }>();
  const spread = (): number => {
    const [a, b] = [...pointers.values()];
    return a !== undefined && b !== undefined ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  };

  element.addEventListener(
    "pointerdown",
    (event) => {
      if (event.button !== 0) return;
      pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      element.setPointerCapture(event.pointerId);
      element.focus({ preventScroll: true });
    },
    { signal },
  );
  element.addEventListener(
    "pointermove",
    (event) => {
      const last = pointers.get(event.pointerId);
      if (last === undefined) return;
      const before = spread();
      pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      if (pointers.size === 1) {
        target.turn(-kRadiansPerPixel * (event.clientX - last.x), kRadiansPerPixel * (event.clientY - last.y), 1);
      } else if (before > 0 && spread() > 0) {
        target.turn(0, 0, before / spread());
      }
    },
    { signal },
  );
  const release = (event: PointerEvent): void => {
    pointers.delete(event.pointerId);
  };
  element.addEventListener("pointerup", release, { signal });
  element.addEventListener("pointercancel", release, { signal });
  element.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const pixels = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? event.deltaY : 40 * event.deltaY;
      target.turn(0, 0, Math.exp(kScalePerPixel * pixels));
    },
    { signal, passive: false },
  );
  element.addEventListener(
    "keydown",
    (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const step = event.shiftKey ? kRadiansPerKey / 4 : kRadiansPerKey;
      const keys: Record<string, () => void> = {
        ArrowLeft: () => target.turn(-step, 0, 1),
        ArrowRight: () => target.turn(step, 0, 1),
        ArrowUp: () => target.turn(0, step, 1),
        ArrowDown: () => target.turn(0, -step, 1),
        "+": () => target.turn(0, 0, 1 / kScalePerKey),
        "=": () => target.turn(0, 0, 1 / kScalePerKey),
        "-": () => target.turn(0, 0, kScalePerKey),
        Home: () => target.reset(),
        " ": () => target.togglePlaying(),
      };
      const act = keys[event.key];
      if (act === undefined) return;
      event.preventDefault();
      act();
    },
    { signal },
  );
}
