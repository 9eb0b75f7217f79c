// node mikktspace.mjs PACKAGE_DIR MESHES TANGENTS
//
// Runs the npm package `mikktspace`, installed in PACKAGE_DIR, over every mesh of the file MESHES
// and writes the tangents to the file TANGENTS. All numbers are 32 bits, little-endian.
//   MESHES:   per mesh the number of corners n, then 3n positions, 3n normals, 2n UVs
//   TANGENTS: per mesh 4n floats: xyz and sign of each corner
// Prints one line a mesh: its corners and the milliseconds the package took.
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";

const [packageDir, meshesPath, tangentsPath] = process.argv.slice(2);
const require = createRequire(join(resolve(packageDir), "package.json"));
const { generateTangents } = require("mikktspace");

const file = readFileSync(meshesPath);
let offset = 0;
const take = (count) => {
    const numbers = new Float32Array(count);
    for (let i = 0; i < count; ++i) numbers[i] = file.readFloatLE(offset + 4 * i);
    offset += 4 * count;
    return numbers;
};

const results = [];
while (offset < file.length) {
    const corners = file.readUInt32LE(offset);
    offset += 4;
    const positions = take(3 * corners);
    const normals = take(3 * corners);
    const uvs = take(2 * corners);
    const begin = performance.now();
    const tangents = generateTangents(positions, normals, uvs);
    console.log(corners, (performance.now() - begin).toFixed(3));
    results.push(Buffer.from(tangents.buffer, tangents.byteOffset, tangents.byteLength));
}
writeFileSync(tangentsPath, Buffer.concat(results));
