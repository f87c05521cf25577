// The main module of the page. This module connects to the server, shows the states in the scene,
// the panel and the plots, and handles the person's input.
import './app.css';
import {App} from './app';
import {takeCodeFromAddress} from './connection';
import {inspection} from './inspect';

const app = new App(document.getElementById('app')!);
window.predictor = inspection(app);
app.start(takeCodeFromAddress());
// The browser does not reload the page for a new fragment in the same tab.
window.addEventListener('hashchange', () => {
  const code = takeCodeFromAddress();
  if (code) app.connection.start(code);
});
