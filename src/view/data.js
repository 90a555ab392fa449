// Data of the page: facts as JSON, and packed arrays of integers.

const facts = JSON.parse(document.getElementById("facts").textContent);

/** Decompresses the data of the page. */
async function unpack() {
  const element = document.getElementById("data");
  const address = "data:application/octet-stream;base64," + element.textContent;
  element.remove();
  const packed = (await fetch(address)).body;
  const stream = packed.pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Returns a function that decodes the array of a name; unknown names give an empty array. */
function decoder(bytes) {
  const entries = new Map(facts.arrays.map(entry => [entry.name, entry]));
  return name => {
    const entry = entries.get(name);
    if (!entry) return new Int32Array(0);
    const { count, stride, planes, offset } = entry;
    const values = new Int32Array(count);
    for (let plane = 0; plane < planes; plane++) {
      const from = offset + plane * count, shift = 8 * plane;
      for (let i = 0; i < count; i++) values[i] |= bytes[from + i] << shift;
    }
    for (let i = 0; i < count; i++) {
      const coded = values[i];
      values[i] = (coded >>> 1 ^ -(coded & 1)) + (i < stride ? 0 : values[i - stride]) | 0;
    }
    return values;
  };
}
