// The page: connects, plays the states into scene, panel and plots, and takes what the person does.
import './app.css';
import {App} from './app';
import {takeCodeFromAddress} from './connection';
import {inspection} from './inspect';

const app = new App(document.getElementById('app')!);
window.predictor = inspection(app);
app.start(takeCodeFromAddress());
// A new address in the same tab is not loaded again.
window.addEventListener('hashchange', () => {
  const code = takeCodeFromAddress();
  if (code) app.connection.start(code);
});
