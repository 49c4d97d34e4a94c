// Saving under a name in the lab's folder. A file that is there is replaced only after a question.

/** What the lab answers to the request `type`, asked again with `replace` where a file of that name
 * is there and the person wants it replaced; null where not. */
export async function saved(lab, type, fields) {
  try {
    return await lab.act(type, fields);
  } catch (error) {
    if (!/ exists;/.test(error.message)) throw error;
    return confirm(`${error.message.split(";")[0]}. Replace it?`) ? lab.act(type, { ...fields, replace: true }) : null;
  }
}

/** Ask for a name, save under it, and say where; whether it was saved. */
export async function saveAs(lab, what, proposed, type, fields) {
  const name = prompt(`Save ${what} in the lab's folder under the name`, proposed);
  const found = name ? await saved(lab, type, { ...fields, name }) : null;
  if (found) lab.notify(`Saved as ${found.file}.`);
  return Boolean(found);
}

/** Have the browser download a text. */
export function download(text, type, name) {
  const link = document.createElement("a");
  Object.assign(link, { href: URL.createObjectURL(new Blob([text], { type })), download: name });
  link.click();
  URL.revokeObjectURL(link.href);
}
