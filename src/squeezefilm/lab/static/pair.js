// The page for a pairing code: six digits, once. What is wrong with them is said in words.

const form = document.getElementById("pair");
const code = document.getElementById("code");
const said = document.getElementById("said");

form.addEventListener("submit", async (event) => {
  event.preventDefault();
  said.hidden = true;
  try {
    const answer = await fetch("/pair", { method: "POST", body: code.value });
    if (answer.ok) {
      location.assign((await answer.json()).home);
      return;
    }
    said.textContent = await answer.text();
  } catch {
    said.textContent = "The lab does not answer; is it still running, and this tablet in its network?";
  }
  said.hidden = false;
  code.select();
});
