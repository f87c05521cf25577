// The names behind the numbers of a state, as the page has them (tests/viewer/frame_test.cpp holds those against
// the program's).
import {readFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const source = readFileSync(
    join(dirname(fileURLToPath(import.meta.url)), '../../../web/src/protocol.ts'), 'utf8');

function list(name) {
  const [, text] = source.match(new RegExp(`export const ${name} = \\[([^\\]]*)\\]`));
  return text.match(/\w+/g);
}

export const kStates = list('kRunStates');
export const kCauses = list('kStopCauses');
