// Reads long lists of decimal numbers in mesh files quickly.

// Parses decimal numbers between white space. Numbers of up to 15 digits are exact, because the
// digits are read as an exact integer and divided by an exact power of ten. JavaScript itself
// parses numbers that are longer or have an exponent.
export function parseNumbers(text: string): Float64Array {
  const end = text.length;
  const numbers = new Float64Array((end >> 1) + 1);
  let count = 0;
  for (let at = 0; at < end;) {
    let code = text.charCodeAt(at);
    if (code <= kSpace) {
      at++;
      continue;
    }
    const from = at;
    const negative = code === kMinus;
    if (negative) code = text.charCodeAt(++at);
    let digits = 0;
    let value = 0;
    let point = -1;  // digits before it
    for (; at < end && code > kSpace; code = text.charCodeAt(++at)) {
      if (code >= kZero && code <= kZero + 9) {
        value = 10 * value + (code - kZero);
        digits++;
      } else if (code === kPoint && point < 0) {
        point = digits;
      } else {
        digits = NaN;
      }
    }
    if (digits > 0 && digits <= kMaxDigits) {
      if (point >= 0) value /= kPowers[digits - point];
      numbers[count++] = negative ? -value : value;
    } else {
      numbers[count++] = Number(text.slice(from, at));
    }
  }
  return numbers.slice(0, count);
}

const kSpace = 32;
const kMinus = 45;
const kPoint = 46;
const kZero = 48;
const kMaxDigits = 15;
const kPowers = Array.from({length: kMaxDigits + 1}, (_, i) => 10 ** i);
