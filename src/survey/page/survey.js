// The questionnaire's page: consent, then the form, then the pseudonym. Data leaves the page only by the button
// "Send", and only to the program that served the page.
'use strict';

const kSections = ['waiting', 'lost', 'consent', 'form', 'stored', 'declined'];
const kToken = 'predictor.survey.token';
const kMaxTries = 4;
const kRetryMs = 1000;

const byId = (id) => document.getElementById(id);
const show = (id) => kSections.forEach((other) => (byId(other).hidden = other !== id));
let socket = null;
let over = false;
let agreed = false;
let sent = false;  // an answer was sent, and the program has not replied yet
let code = null;
let tries = 0;     // attempts to reach the program since its last message

function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

function lose(reason) {
  over = true;
  byId('lost-reason').textContent = reason;
  show('lost');
}

// ---- the form

function choice(statement, value, words) {
  const input = element('input', {type: 'radio', name: statement, value});
  if (value === '') input.checked = true;
  return element('label', {}, input, words);
}

function question({name, text}, scale) {
  const levels = element('div', {class: 'levels'},
                         ...scale.map((level) => choice(name, level.score, level.name)),
                         choice(name, '', 'No answer'));
  return element('fieldset', {id: name}, element('legend', {}, `${name}. ${text}`), levels);
}

function build({consent, condition, statements, scale, longest_comment}) {
  byId('consent-text').textContent = consent;
  byId('condition').hidden = condition !== null;
  const known = document.querySelector(`input[name=condition][value=${condition ?? 'real'}]`);
  known.checked = condition !== null;
  byId('comment').maxLength = longest_comment;
  byId('statements').replaceChildren(...statements.map((s) => question(s, scale)));
  byId('statements').dataset.names = statements.map((s) => s.name).join(' ');
  show(agreed ? 'form' : 'consent');
}

const chosen = (name) => document.querySelector(`input[name=${name}]:checked`)?.value ?? '';

// Returns a number if the text is one. Other text is returned unchanged, so that the program rejects it with a
// message.
function typedNumber(text) {
  if (text === '') return null;
  return /^-?\d+$/.test(text) ? Number(text) : text;
}

function answer() {
  const names = byId('statements').dataset.names.split(' ');
  return {
    type: 'answer', consent: agreed, condition: chosen('condition'),
    answers: Object.fromEntries(names.map((name) => [name, typedNumber(chosen(name))])),
    age: typedNumber(byId('age').value.trim()), sex: byId('sex').value || null,
    comment: byId('comment').value.trim(),
    pseudonym: byId('pseudonym').value.trim().toUpperCase() || null,
  };
}

function deny({field, reason}) {
  sent = false;
  byId('send').disabled = false;
  byId('problem').textContent = reason;
  byId('problem').hidden = false;
  const where = byId(field === 'answers' ? 'S1' : field);
  where?.classList.add('wrong');
  where?.scrollIntoView({block: 'center'});
}

function forgive() {
  byId('problem').hidden = true;
  for (const wrong of document.querySelectorAll('.wrong')) wrong.classList.remove('wrong');
}

// ---- the program

function onMessage(message) {
  switch (message.type) {
    case 'welcome':
      sessionStorage.setItem(kToken, message.token);
      tries = 0;
      sent = false;
      byId('send').disabled = false;
      if (!byId('statements').dataset.names) build(message);  // otherwise, the person's entries are kept
      break;
    case 'refused':
      lose(`${message.reason} Ask the experimenter for a new one.`);
      break;
    case 'denied':
      deny(message);
      break;
    case 'stored':
      over = true;
      byId('your-pseudonym').textContent = message.pseudonym;
      byId('form').reset();
      show('stored');
      break;
    case 'declined':
      over = true;
      show('declined');
      break;
  }
}

// The program runs until it has an answer. A connection may be lost earlier, for instance because the computer was
// asleep.
function onClose() {
  if (over) return;
  if (++tries < kMaxTries) {
    setTimeout(connect, kRetryMs);
    return;
  }
  lose(sent ? 'The program has ended. Ask the experimenter whether your answer was stored.' :
              'The program has ended. Nothing was stored.');
}

function connect() {
  const token = sessionStorage.getItem(kToken);
  socket = new WebSocket(`ws://${location.host}/ws`, 'predictor.survey.v1');
  socket.addEventListener('open', () => socket.send(JSON.stringify({type: 'hello', code, token})));
  socket.addEventListener('message', ({data}) => onMessage(JSON.parse(data)));
  socket.addEventListener('close', onClose);
}

// Sends the message if there is a connection; otherwise, does nothing.
const send = (message) => socket.readyState === WebSocket.OPEN && socket.send(JSON.stringify(message));

byId('agree').addEventListener('click', () => {
  agreed = true;
  show('form');
  scrollTo(0, 0);
});
byId('decline').addEventListener('click', () => send({type: 'decline'}));
byId('withdraw').addEventListener('click', () => send({type: 'decline'}));
byId('form').addEventListener('input', forgive);
byId('form').addEventListener('submit', (event) => {
  event.preventDefault();
  forgive();
  byId('send').disabled = true;
  sent = true;
  send(answer());
});

code = new URLSearchParams(location.hash.slice(1)).get('code');
history.replaceState(null, '', location.pathname);
connect();
