/** Names set in as many lines as make them largest. */

/** Width of a letter and distance of lines, as shares of the height of type, about. */
const LETTER = 0.66;
const LINE = 1.15;
/** Lines at most, and letters that a name counts for at least. */
const MOST = 3;
const LEAST = 6;

export interface Label {
  lines: string[];
  /** Height of type, in the unit of the place. */
  size: number;
}

/** Returns a name as it fits a place, with a line more below it for a figure; the type is no larger than `most`. */
export function labelFor(name: string, width: number, height: number, most: number): Label {
  let best: Label = { lines: [name], size: 0 };
  for (let count = 1; count <= MOST; count++) {
    for (const lines of splits(name.split(" "), count)) {
      const longest = Math.max(LEAST, ...lines.map((line) => line.length));
      const size = Math.min(most, width / (longest * LETTER), height / ((count + 1) * LINE));
      if (size > best.size * 1.05) best = { lines, size };
    }
  }
  return best;
}

/** Returns every way to put words into so many lines. */
function splits(words: string[], count: number): string[][] {
  if (count === 1) return [[words.join(" ")]];
  const found: string[][] = [];
  for (let first = 1; first <= words.length - count + 1; first++) {
    for (const rest of splits(words.slice(first), count - 1)) found.push([words.slice(0, first).join(" "), ...rest]);
  }
  return found;
}

/** Returns where a line stands, by its number, in heights of type from the middle of the name; the figure comes after the last. */
export function lineAt(label: Label, line: number): number {
  return (line - (label.lines.length - 1) / 2) * LINE * label.size;
}
