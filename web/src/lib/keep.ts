/** What the browser keeps of the work between two visits: one record in IndexedDB. */
const STORE = "work";

function opened(): Promise<IDBDatabase> {
  return new Promise((done, failed) => {
    const request = indexedDB.open("d3dgen", 1);
    request.onupgradeneeded = () => request.result.createObjectStore(STORE);
    request.onsuccess = () => done(request.result);
    request.onerror = () => failed(request.error);
  });
}

async function inStore<T>(mode: IDBTransactionMode, act: (store: IDBObjectStore) => IDBRequest<T>): Promise<T> {
  const database = await opened();
  try {
    return await new Promise((done, failed) => {
      const request = act(database.transaction(STORE, mode).objectStore(STORE));
      request.onsuccess = () => done(request.result);
      request.onerror = () => failed(request.error);
    });
  } finally {
    database.close();
  }
}

/** Returns what was kept under a name; nothing in a browser that keeps nothing. */
export async function kept<T>(name: string): Promise<T | undefined> {
  try {
    return await inStore<T | undefined>("readonly", (store) => store.get(name));
  } catch {
    return undefined;
  }
}

/** Keeps a value under a name; returns false where the browser keeps nothing. */
export async function keep(name: string, value: unknown): Promise<boolean> {
  try {
    await inStore("readwrite", (store) => store.put(value, name));
    return true;
  } catch {
    return false;
  }
}
