// Lays out the sentences on the headset's board. The sentences stay above the bars of the hands,
// regardless of the length of the sentences.

export interface BoardText {
  title: string;
  tone: 'calm' | 'ready' | 'running' | 'warning' | 'stopped';
  text: string;       // instruction, or cause of the stop
  advice: string;
  prompt: string;     // prompt of the registration
  alarm: string;      // drift, connection
}

export const kBarsFrom = 490;  // distance from the top of the board [px]

// Lengths are in pixels of the board. The distance from the top to the baseline is y.
export interface Line {
  text: string;
  y: number;
  size: number;
  color: string;
}

const kTop = 128;        // top of the sentences
const kSmaller = 0.95;
const kSmallest = 0.5;  // smaller letters cannot be read
export const kTones = {calm: '#9aa7b8', ready: '#2fbf71', running: '#2fbf71', warning: '#ff9f1c',
                       stopped: '#f23645'};

// Returns the y coordinate of the lowest point of the last line.
export function endOf(lines: Line[]): number {
  const {y, size} = lines[lines.length - 1];
  return y + 0.25 * size;
}

export function layOut(text: BoardText): Line[] {
  let scale = 1;
  let lines = scaled(text, scale);
  // If a text is long, its letters become smaller. No text is cut off, because the person may need
  // exactly the missing part.
  while (endOf(lines) > kBarsFrom && scale > kSmallest) {
    scale *= kSmaller;
    lines = scaled(text, scale);
  }
  return lines;
}

function scaled(text: BoardText, scale: number): Line[] {
  const color = text.tone === 'stopped' ? kTones.stopped : '#fff';
  const lines: Line[] = [{text: text.title, y: 96, size: 64, color}];
  const sentences = [
    {text: text.text, size: 40, color: '#e8edf4', columns: 40},
    {text: text.advice, size: 34, color: '#9aa7b8', columns: 46},
    {text: text.prompt, size: 38, color: '#7cc0ff', columns: 42},
    {text: text.alarm, size: 38, color: '#ffb347', columns: 42},
  ];
  let y = kTop + 40 * scale;
  for (const sentence of sentences) {
    const size = sentence.size * scale;
    for (const line of sentence.text ? wrap(sentence.text, sentence.columns / scale) : []) {
      lines.push({text: line, y, size, color: sentence.color});
      y += 1.25 * size;
    }
    y += 4 * scale;
  }
  return lines;
}

export function wrap(text: string, columns: number): string[] {
  const lines = [''];
  for (const word of text.split(' ')) {
    const last = lines[lines.length - 1];
    if (last && last.length + word.length + 1 > columns) {
      lines.push(word);
    } else {
      lines[lines.length - 1] = last ? `${last} ${word}` : word;
    }
  }
  return lines;
}
