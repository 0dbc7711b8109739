// The values of attributes that are more than a word.

import type { Sight } from "./messages.js";

const kAngle = /^(-?\d+(?:\.\d+)?)(deg|rad)$/;
const kLength = /^(\d+(?:\.\d+)?)(m|cm|mm|%)$/;

function angle(text: string): number | undefined {
  const found = kAngle.exec(text);
  if (found === null) throw new Error(`"${text}" is no angle such as 45deg`);
  return Number(found[1]) * (found[2] === "deg" ? Math.PI / 180 : 1);
}

/** As <model-viewer> has it: azimuth, angle from the zenith, distance; "auto" leaves one open. Throws Error. */
export function parseCameraOrbit(text: string): Sight {
  const words = text.trim().split(/\s+/);
  const [azimuth, polar, distance] = words;
  if (azimuth === undefined || polar === undefined || words.length > 3) {
    throw new Error(`camera-orbit="${text}" is not of the form "45deg 70deg 2.5m" or "45deg 70deg 105%"`);
  }
  const sight: Sight = {};
  try {
    if (azimuth !== "auto") sight.azimuth = angle(azimuth);
    if (polar !== "auto") {
      const zenith = angle(polar) ?? 0;
      sight.elevation = Math.max(-kSteepest, Math.min(kSteepest, Math.PI / 2 - zenith));
    }
    if (distance !== undefined && distance !== "auto") {
      const found = kLength.exec(distance);
      const number = Number(found?.[1]);
      if (found === null || !(number > 0)) throw new Error(`"${distance}" is no distance such as 2.5m or 105%`);
      const metres: Record<string, number> = { m: 1, cm: 0.01, mm: 0.001 };
      if (found[2] === "%") sight.scale = number / 100;
      else sight.distance = number * (metres[found[2] ?? "m"] ?? 1);
    }
  } catch (error) {
    throw new Error(`camera-orbit="${text}": ${error instanceof Error ? error.message : String(error)}`);
  }
  return sight;
}

/** Radians: the steepest sight from above or below. */
export const kSteepest = 1.5;

/** A factor on light, or "auto". Throws Error. */
export function parseExposure(text: string): number | "auto" {
  const trimmed = text.trim();
  if (trimmed === "auto") return "auto";
  const factor = trimmed === "" ? NaN : Number(trimmed);
  if (!(factor > 0) || !Number.isFinite(factor)) throw new Error(`exposure="${text}" is no positive number and not "auto"`);
  return factor;
}
