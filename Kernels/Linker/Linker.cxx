// SPDX-License-Identifier: BSD-3-Clause
// A linker for the compiled kernels of PoCL on x86-64, for systems without a working linker. It
// links object files to a shared library. It supports the output of LLVM for position-independent
// code, and reports an error for anything else: code without -fPIC, thread-local or common symbols,
// archives and linker scripts.
//
// Usage, as for ld: ld -shared -o LIBRARY [OPTION]... OBJECT...
// Libraries (-l) are ignored: the dynamic loader finds the functions of libc and libm when the
// kernels are loaded. Other options are ignored, too.
#include <elf.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{

using Bytes = std::vector<char>;

const std::uint64_t Page = 4096;

std::uint64_t Align(std::uint64_t value, std::uint64_t to)
{
  return to > 1 ? (value + to - 1) / to * to : value;
}

template <typename T>
T Read(const Bytes& bytes, std::uint64_t at)
{
  if (at > bytes.size() || bytes.size() - at < sizeof(T))
  {
    throw std::runtime_error("an object file is truncated");
  }
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

template <typename T>
void Write(Bytes& bytes, std::uint64_t at, const T& value)
{
  if (at > bytes.size() || bytes.size() - at < sizeof(T))
  {
    throw std::runtime_error("a relocation is outside its section");
  }
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

template <typename T>
void Append(Bytes& bytes, const T& value)
{
  const char* const begin = reinterpret_cast<const char*>(&value);
  bytes.insert(bytes.end(), begin, begin + sizeof(T));
}

std::string ReadText(const Bytes& bytes, std::uint64_t at)
{
  std::string text;
  for (char c; (c = Read<char>(bytes, at)) != 0; ++at)
  {
    text += c;
  }
  return text;
}

struct Section
{
  Elf64_Shdr Header{};
  std::string Name;
  std::uint64_t Address = 0; // in the library
  bool IsLoaded() const
  {
    return (this->Header.sh_flags & SHF_ALLOC) && this->Header.sh_type != SHT_NOTE;
  }
  bool IsWritten() const { return this->Header.sh_flags & SHF_WRITE; }
};

struct Object
{
  Bytes File;
  std::vector<Section> Sections;
  std::vector<Elf64_Sym> Symbols;
  std::vector<std::string> Names; // of symbols
};

Object ReadObject(const std::string& path)
{
  Object object;
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
  {
    throw std::runtime_error("cannot read " + path);
  }
  object.File.assign(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
  const auto header = Read<Elf64_Ehdr>(object.File, 0);
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_ident[EI_CLASS] != ELFCLASS64 ||
    header.e_type != ET_REL || header.e_machine != EM_X86_64)
  {
    throw std::runtime_error(path + " is not an object file for x86-64");
  }
  for (unsigned int i = 0; i < header.e_shnum; ++i)
  {
    Section section;
    section.Header = Read<Elf64_Shdr>(object.File, header.e_shoff + i * sizeof(Elf64_Shdr));
    object.Sections.push_back(section);
  }
  if (header.e_shstrndx >= object.Sections.size())
  {
    throw std::runtime_error(path + " has no section name table");
  }
  const std::uint64_t names = object.Sections[header.e_shstrndx].Header.sh_offset;
  for (Section& section : object.Sections)
  {
    section.Name = ReadText(object.File, names + section.Header.sh_name);
    if (section.Header.sh_type != SHT_SYMTAB)
    {
      continue;
    }
    if (section.Header.sh_link >= object.Sections.size())
    {
      throw std::runtime_error(path + " has no symbol name table");
    }
    const std::uint64_t texts = object.Sections[section.Header.sh_link].Header.sh_offset;
    for (std::uint64_t at = 0; at < section.Header.sh_size; at += sizeof(Elf64_Sym))
    {
      object.Symbols.push_back(Read<Elf64_Sym>(object.File, section.Header.sh_offset + at));
      object.Names.push_back(ReadText(object.File, texts + object.Symbols.back().st_name));
    }
  }
  return object;
}

class Library
{
public:
  explicit Library(std::vector<Object> objects)
    : Objects(std::move(objects))
  {
  }

  Bytes Make()
  {
    this->ListSymbols();
    this->CountSlots();
    this->LayOut();
    this->CopySections();
    this->Relocate();
    this->FillTables();
    return std::move(this->File);
  }

private:
  struct Global
  {
    std::uint64_t Address = 0;
    std::uint32_t Index = 0; // in the dynamic symbol table
    bool IsDefined = false;
    Elf64_Sym Symbol{};
    const Object* From = nullptr;
  };

  // Collects the defined symbols, and the undefined symbols that the dynamic loader must find.
  void ListSymbols()
  {
    for (const Object& object : this->Objects)
    {
      for (std::size_t i = 0; i < object.Symbols.size(); ++i)
      {
        const Elf64_Sym& symbol = object.Symbols[i];
        if (ELF64_ST_BIND(symbol.st_info) == STB_LOCAL || object.Names[i].empty())
        {
          continue;
        }
        if (symbol.st_shndx == SHN_COMMON || ELF64_ST_TYPE(symbol.st_info) == STT_TLS)
        {
          throw std::runtime_error(
            "common and thread-local symbols are not supported: " + object.Names[i]);
        }
        Global& global = this->Globals[object.Names[i]];
        if (symbol.st_shndx == SHN_UNDEF)
        {
          if (!global.IsDefined)
          {
            global.Symbol = symbol;
          }
          continue;
        }
        if (global.IsDefined && ELF64_ST_BIND(global.Symbol.st_info) != STB_WEAK &&
          ELF64_ST_BIND(symbol.st_info) != STB_WEAK)
        {
          throw std::runtime_error("symbol defined twice: " + object.Names[i]);
        }
        if (!global.IsDefined || ELF64_ST_BIND(global.Symbol.st_info) == STB_WEAK)
        {
          global.IsDefined = true;
          global.Symbol = symbol;
          global.From = &object;
        }
      }
    }
    this->Texts.push_back('\0');
    this->Dynamic.push_back(Elf64_Sym{});
    for (auto& [name, global] : this->Globals)
    {
      const auto visibility = ELF64_ST_VISIBILITY(global.Symbol.st_other);
      if (global.IsDefined && visibility != STV_DEFAULT && visibility != STV_PROTECTED)
      {
        continue;
      }
      global.Index = static_cast<std::uint32_t>(this->Dynamic.size());
      Elf64_Sym symbol = global.Symbol;
      symbol.st_name = this->AddText(name);
      this->Dynamic.push_back(symbol);
    }
    for (const char* const needed : { "libm.so.6", "libc.so.6" })
    {
      this->Needed.push_back(this->AddText(needed));
    }
  }

  std::uint32_t AddText(const std::string& text)
  {
    const auto at = static_cast<std::uint32_t>(this->Texts.size());
    this->Texts.insert(this->Texts.end(), text.c_str(), text.c_str() + text.size() + 1);
    return at;
  }

  // Calls f(object, section, relocation) for all relocations in loaded sections.
  template <typename Function>
  void ForRelocations(Function f)
  {
    for (const Object& object : this->Objects)
    {
      for (const Section& list : object.Sections)
      {
        if (list.Header.sh_type == SHT_REL)
        {
          throw std::runtime_error("relocations without addends (SHT_REL) are not supported");
        }
        if (list.Header.sh_type != SHT_RELA || list.Header.sh_info >= object.Sections.size())
        {
          continue;
        }
        const Section& section = object.Sections[list.Header.sh_info];
        if (!section.IsLoaded())
        {
          continue;
        }
        for (std::uint64_t at = 0; at < list.Header.sh_size; at += sizeof(Elf64_Rela))
        {
          const auto relocation = Read<Elf64_Rela>(object.File, list.Header.sh_offset + at);
          if (ELF64_R_SYM(relocation.r_info) >= object.Symbols.size())
          {
            throw std::runtime_error("a relocation refers to symbol " +
              std::to_string(ELF64_R_SYM(relocation.r_info)) + ", but there are only " +
              std::to_string(object.Symbols.size()));
          }
          f(object, section, relocation);
        }
      }
    }
  }

  static bool IsByTable(std::uint32_t type)
  {
    return type == R_X86_64_GOTPCREL || type == R_X86_64_GOTPCRELX ||
      type == R_X86_64_REX_GOTPCRELX;
  }

  // Returns the key of a symbol in Slots and Jumps. Local symbols of different objects differ.
  std::string GetKey(const Object& object, std::uint32_t index) const
  {
    const bool isLocal = ELF64_ST_BIND(object.Symbols[index].st_info) == STB_LOCAL;
    return isLocal ? std::to_string(&object - this->Objects.data()) + "/" + std::to_string(index)
                   : ":" + object.Names[index];
  }

  bool IsDefined(const Object& object, std::uint32_t index) const
  {
    const Elf64_Sym& symbol = object.Symbols[index];
    if (ELF64_ST_BIND(symbol.st_info) == STB_LOCAL)
    {
      return true;
    }
    return this->Globals.at(object.Names[index]).IsDefined;
  }

  void CountSlots()
  {
    this->ForRelocations(
      [&](const Object& object, const Section&, const Elf64_Rela& relocation)
      {
        const auto type = static_cast<std::uint32_t>(ELF64_R_TYPE(relocation.r_info));
        const auto index = static_cast<std::uint32_t>(ELF64_R_SYM(relocation.r_info));
        const bool isCall = type == R_X86_64_PLT32 && !this->IsDefined(object, index);
        if (IsByTable(type) || isCall)
        {
          const std::string key = this->GetKey(object, index);
          this->Slots.insert({ key, this->Slots.size() });
          if (isCall)
          {
            this->Jumps.insert({ key, this->Jumps.size() });
          }
        }
        if (IsByTable(type) || isCall || type == R_X86_64_64)
        {
          ++this->MostDynamicRelocations; // an upper bound: several may share a slot
        }
      });
  }

  // Assigns addresses, which equal the offsets in the file. There are two loaded segments: one for
  // reading and execution, and one for reading and writing.
  void LayOut()
  {
    std::uint64_t at = sizeof(Elf64_Ehdr) + Segments * sizeof(Elf64_Phdr);
    const auto take = [&](std::uint64_t size, std::uint64_t alignment)
    {
      at = Align(at, alignment);
      const std::uint64_t begin = at;
      at += size;
      return begin;
    };
    this->HashAt = take(4 * (3 + this->Dynamic.size()), 8);
    this->SymbolsAt = take(sizeof(Elf64_Sym) * this->Dynamic.size(), 8);
    this->TextsAt = take(this->Texts.size(), 1);
    this->RelocationsAt = take(sizeof(Elf64_Rela) * this->MostDynamicRelocations, 8);
    this->JumpsAt = take(JumpSize * this->Jumps.size(), 16);
    this->LayOutSections(false, take);
    this->ReadEnd = at;
    at = Align(at, Page);
    this->WrittenAt = at;
    this->SlotsAt = take(8 * this->Slots.size(), 8);
    this->DynamicAt = take(sizeof(Elf64_Dyn) * DynamicEntries, 16);
    this->LayOutSections(true, take);
    this->File.assign(at, '\0');
    for (auto& [name, global] : this->Globals)
    {
      if (global.IsDefined)
      {
        global.Address = this->GetAddress(*global.From, global.Symbol);
        if (global.Index)
        {
          this->Dynamic[global.Index].st_value = global.Address;
          this->Dynamic[global.Index].st_shndx = 1; // any section number except SHN_UNDEF
        }
      }
    }
  }

  template <typename Take>
  void LayOutSections(bool written, Take take)
  {
    for (Object& object : this->Objects)
    {
      for (Section& section : object.Sections)
      {
        if (section.IsLoaded() && section.IsWritten() == written)
        {
          if (section.Header.sh_flags & SHF_TLS)
          {
            throw std::runtime_error("thread-local sections are not supported: " + section.Name);
          }
          section.Address = take(section.Header.sh_size, section.Header.sh_addralign);
        }
      }
    }
  }

  void CopySections()
  {
    for (const Object& object : this->Objects)
    {
      for (const Section& section : object.Sections)
      {
        const std::uint64_t size = section.Header.sh_size;
        if (!section.IsLoaded() || section.Header.sh_type == SHT_NOBITS || size == 0)
        {
          continue;
        }
        Read<char>(object.File, section.Header.sh_offset + size - 1);
        std::memcpy(
          this->File.data() + section.Address, object.File.data() + section.Header.sh_offset, size);
      }
    }
  }

  std::uint64_t GetAddress(const Object& object, const Elf64_Sym& symbol) const
  {
    if (symbol.st_shndx == SHN_ABS)
    {
      throw std::runtime_error("absolute symbols are not supported");
    }
    if (symbol.st_shndx == SHN_UNDEF)
    {
      // This is symbol 0. The value of such a relocation does not depend on the load address.
      throw std::runtime_error("relocations without a symbol are not supported");
    }
    if (symbol.st_shndx >= object.Sections.size() || !object.Sections[symbol.st_shndx].IsLoaded())
    {
      throw std::runtime_error("a symbol is in a section that is not loaded");
    }
    return object.Sections[symbol.st_shndx].Address + symbol.st_value;
  }

  void Relocate()
  {
    this->ForRelocations(
      [&](const Object& object, const Section& section, const Elf64_Rela& relocation)
      { this->Relocate(object, section, relocation); });
    for (const auto& [key, slot] : this->Slots)
    {
      const auto found = this->Jumps.find(key);
      if (found != this->Jumps.end())
      {
        const std::uint64_t jump = this->JumpsAt + JumpSize * found->second;
        Write<std::uint16_t>(this->File, jump, 0x25ff); // jmp *slot(%rip)
        const std::int64_t distance =
          static_cast<std::int64_t>(this->SlotsAt + 8 * slot) - static_cast<std::int64_t>(jump + 6);
        Write<std::int32_t>(this->File, jump + 2, static_cast<std::int32_t>(distance));
      }
    }
  }

  void Relocate(const Object& object, const Section& section, const Elf64_Rela& relocation)
  {
    const auto type = static_cast<std::uint32_t>(ELF64_R_TYPE(relocation.r_info));
    const auto index = static_cast<std::uint32_t>(ELF64_R_SYM(relocation.r_info));
    const std::string& name = object.Names[index];
    if (type == R_X86_64_NONE)
    {
      return;
    }
    const bool isDefined = this->IsDefined(object, index);
    const bool isLocal = ELF64_ST_BIND(object.Symbols[index].st_info) == STB_LOCAL;
    std::uint64_t address = 0;
    if (isDefined)
    {
      address =
        isLocal ? this->GetAddress(object, object.Symbols[index]) : this->Globals.at(name).Address;
    }
    const std::uint32_t dynamic = isLocal ? 0 : this->Globals.at(name).Index;
    const std::uint64_t target = section.Address + relocation.r_offset;
    if (relocation.r_offset >= section.Header.sh_size)
    {
      throw std::runtime_error("a relocation is outside its section");
    }
    if (type == R_X86_64_64)
    {
      if (!section.IsWritten())
      {
        throw std::runtime_error("not compiled with -fPIC: section " + section.Name);
      }
      this->AddDynamicRelocation(
        target, isDefined, R_X86_64_64, dynamic, address, relocation.r_addend);
      return;
    }
    if (IsByTable(type) || (type == R_X86_64_PLT32 && !isDefined))
    {
      const std::string key = this->GetKey(object, index);
      const std::uint64_t slot = this->SlotsAt + 8 * this->Slots.at(key);
      if (this->FilledSlots.insert({ key, true }).second)
      {
        this->AddDynamicRelocation(slot, isDefined, R_X86_64_GLOB_DAT, dynamic, address, 0);
      }
      address = IsByTable(type) ? slot : this->JumpsAt + JumpSize * this->Jumps.at(key);
    }
    else if (type != R_X86_64_PC32 && type != R_X86_64_PLT32 && type != R_X86_64_PC64)
    {
      throw std::runtime_error(
        "relocation type " + std::to_string(type) + " is not supported: " + name);
    }
    else if (!isDefined)
    {
      throw std::runtime_error("undefined symbol, and not a function call: " + name);
    }
    const auto value =
      static_cast<std::int64_t>(address + static_cast<std::uint64_t>(relocation.r_addend) - target);
    if (type == R_X86_64_PC64)
    {
      Write<std::int64_t>(this->File, target, value);
      return;
    }
    if (value != static_cast<std::int32_t>(value))
    {
      throw std::runtime_error("relocation out of range: " + name);
    }
    Write<std::int32_t>(this->File, target, static_cast<std::int32_t>(value));
  }

  void AddDynamicRelocation(std::uint64_t target, bool isDefined, std::uint32_t type,
    std::uint32_t symbol, std::uint64_t address, std::int64_t addend)
  {
    Elf64_Rela relocation{};
    relocation.r_offset = target;
    relocation.r_info =
      isDefined ? ELF64_R_INFO(0, R_X86_64_RELATIVE) : ELF64_R_INFO(std::uint64_t{ symbol }, type);
    relocation.r_addend = isDefined ? static_cast<std::int64_t>(address) + addend : addend;
    this->DynamicRelocations.push_back(relocation);
  }

  void FillTables()
  {
    const auto count = static_cast<std::uint32_t>(this->Dynamic.size());
    // A hash table with one bucket: a search is linear, but there are few symbols.
    Bytes hash;
    Append<std::uint32_t>(hash, 1);
    Append<std::uint32_t>(hash, count);
    Append<std::uint32_t>(hash, count > 1 ? 1 : 0);
    for (std::uint32_t i = 0; i < count; ++i)
    {
      Append<std::uint32_t>(hash, i > 0 && i + 1 < count ? i + 1 : 0);
    }
    std::memcpy(this->File.data() + this->HashAt, hash.data(), hash.size());
    std::memcpy(
      this->File.data() + this->SymbolsAt, this->Dynamic.data(), count * sizeof(Elf64_Sym));
    std::memcpy(this->File.data() + this->TextsAt, this->Texts.data(), this->Texts.size());
    const std::size_t relocations = this->DynamicRelocations.size() * sizeof(Elf64_Rela);
    if (relocations)
    {
      std::memcpy(
        this->File.data() + this->RelocationsAt, this->DynamicRelocations.data(), relocations);
    }

    std::uint64_t at = this->DynamicAt;
    const auto add = [&](std::int64_t tag, std::uint64_t value)
    {
      Elf64_Dyn entry{};
      entry.d_tag = tag;
      entry.d_un.d_val = value;
      Write(this->File, at, entry);
      at += sizeof(entry);
    };
    for (const std::uint32_t needed : this->Needed)
    {
      add(DT_NEEDED, needed);
    }
    add(DT_HASH, this->HashAt);
    add(DT_STRTAB, this->TextsAt);
    add(DT_STRSZ, this->Texts.size());
    add(DT_SYMTAB, this->SymbolsAt);
    add(DT_SYMENT, sizeof(Elf64_Sym));
    if (relocations)
    {
      add(DT_RELA, this->RelocationsAt);
      add(DT_RELASZ, relocations);
      add(DT_RELAENT, sizeof(Elf64_Rela));
    }
    add(DT_FLAGS, DF_BIND_NOW);
    add(DT_NULL, 0);

    Elf64_Ehdr header{};
    std::memcpy(header.e_ident, ELFMAG, SELFMAG);
    header.e_ident[EI_CLASS] = ELFCLASS64;
    header.e_ident[EI_DATA] = ELFDATA2LSB;
    header.e_ident[EI_VERSION] = EV_CURRENT;
    header.e_type = ET_DYN;
    header.e_machine = EM_X86_64;
    header.e_version = EV_CURRENT;
    header.e_phoff = sizeof(Elf64_Ehdr);
    header.e_ehsize = sizeof(Elf64_Ehdr);
    header.e_phentsize = sizeof(Elf64_Phdr);
    header.e_phnum = Segments;
    header.e_shentsize = sizeof(Elf64_Shdr);
    Write(this->File, 0, header);
    const std::uint64_t end = this->File.size();
    this->AddSegment(0, PT_LOAD, PF_R | PF_X, 0, this->ReadEnd, Page);
    this->AddSegment(1, PT_LOAD, PF_R | PF_W, this->WrittenAt, end - this->WrittenAt, Page);
    this->AddSegment(2, PT_DYNAMIC, PF_R | PF_W, this->DynamicAt, at - this->DynamicAt, 16);
    this->AddSegment(3, PT_GNU_STACK, PF_R | PF_W, 0, 0, 16);
  }

  void AddSegment(unsigned int number, std::uint32_t type, std::uint32_t flags, std::uint64_t at,
    std::uint64_t size, std::uint64_t alignment)
  {
    Elf64_Phdr segment{};
    segment.p_type = type;
    segment.p_flags = flags;
    segment.p_offset = segment.p_vaddr = segment.p_paddr = at;
    segment.p_filesz = segment.p_memsz = size;
    segment.p_align = alignment;
    Write(this->File, sizeof(Elf64_Ehdr) + number * sizeof(segment), segment);
  }

  static constexpr unsigned int Segments = 4;
  static constexpr unsigned int JumpSize = 8;
  static constexpr unsigned int DynamicEntries = 16;

  std::vector<Object> Objects;
  std::map<std::string, Global> Globals;
  Bytes Texts;
  std::vector<Elf64_Sym> Dynamic;
  std::vector<std::uint32_t> Needed;
  std::map<std::string, std::uint64_t> Slots; // entries of the global offset table (GOT)
  std::map<std::string, std::uint64_t> Jumps; // entries of the procedure linkage table (PLT)
  std::map<std::string, bool> FilledSlots;
  std::size_t MostDynamicRelocations = 0;
  std::vector<Elf64_Rela> DynamicRelocations;
  Bytes File;
  std::uint64_t HashAt = 0;
  std::uint64_t SymbolsAt = 0;
  std::uint64_t TextsAt = 0;
  std::uint64_t RelocationsAt = 0;
  std::uint64_t JumpsAt = 0;
  std::uint64_t ReadEnd = 0;
  std::uint64_t WrittenAt = 0;
  std::uint64_t SlotsAt = 0;
  std::uint64_t DynamicAt = 0;
};

void Link(const std::vector<std::string>& arguments)
{
  std::string output = "a.out";
  bool isShared = false;
  std::vector<Object> objects;
  for (std::size_t i = 0; i < arguments.size(); ++i)
  {
    const std::string& argument = arguments[i];
    const bool hasValue = argument == "-o" || argument == "-m" || argument == "-L" ||
      argument == "-l" || argument == "-z" || argument == "-soname" || argument == "-h";
    if (hasValue && ++i >= arguments.size())
    {
      throw std::runtime_error("option " + argument + " needs a value");
    }
    if (argument == "-o")
    {
      output = arguments[i];
    }
    else if (argument == "-shared" || argument == "--shared")
    {
      isShared = true;
    }
    else if (!hasValue && argument[0] != '-')
    {
      objects.push_back(ReadObject(argument));
    }
  }
  if (!isShared)
  {
    throw std::runtime_error("only shared libraries are supported: pass -shared");
  }
  const Bytes library = Library(std::move(objects)).Make();
  std::ofstream stream(output, std::ios::binary | std::ios::trunc);
  stream.write(library.data(), static_cast<std::streamsize>(library.size()));
  stream.close();
  if (!stream)
  {
    throw std::runtime_error("cannot write " + output);
  }
}

} // namespace

int main(int argc, char* argv[])
{
  try
  {
    std::vector<std::string> arguments;
    for (int i = 1; i < argc; ++i)
    {
      if (argv[i][0])
      {
        arguments.emplace_back(argv[i]);
      }
    }
    Link(arguments);
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "ld of DeformVolume: %s\n", error.what());
    return 1;
  }
  return 0;
}
